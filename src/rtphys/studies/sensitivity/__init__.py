"""`sensitivity`: how far an attribute may be from nominal before a task is lost."""
