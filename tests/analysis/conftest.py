"""Jobs are done in this process."""

from quick_pool import in_process  # noqa: F401  (a fixture)
