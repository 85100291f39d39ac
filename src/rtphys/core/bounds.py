"""Bounds on what is read from files that others may have written.

What one format alone needs stands with its reader.
"""

NAME_BYTES = 200  # of a task, a configuration, a protocol; a file system takes 255
FILE_BYTES = 2**29  # of a file that is read as a whole, such as a video or a mesh
LINE_BYTES = 2**26  # of one line of a log; ours have 2 kB, with a hundred pieces of clutter 20
JSON_BYTES = 2**28  # of a JSON document; a manifest has about 12 kB a task
JSON_ITEMS = 10_000_000  # commas and brackets of a document: about 1.5 GB of Python objects
JSON_DEPTH = 64  # deepest of our own files: 9
LIST_BYTES = 2**24  # of a protocol's certified lists; 50 tasks of 7,000 instances
YAML_BYTES = 2**18  # longest of our own files: 20 kB; 130,000 values take a second
YAML_DEPTH = 32
YAML_ALIASES = 8  # they multiply: 8 make at most 18 times as many values; our own files have none
WHOLE_NUMBER = 2**63 - 1  # numpy's largest; also of a seed
EPISODES = 10_000_000  # of a task, and attempts
SHARDS = 10_000
SHOWN_CHARACTERS = 400  # characters of a value that an error shows
LARGEST_EPISODE = 2**32  # [bytes] of an HDF5 file; 200 frames of three 320x240 depths: 0.4e9
MAX_EXPANSION = 256  # of a file by its compressed arrays, each; ours: 100 times at most
LARGEST_VIDEO = 2**28  # [bytes] of an MP4
MAX_LINKS = 1024  # names in an HDF5 file; an episode has 60 to 150
DEEPEST_LINK = 8  # names in a path of an HDF5 file; an episode has 3
MAX_PIXELS = 2**22  # of one picture or video frame, 2048x2048
MAX_SCANS = 16  # of one JPEG; ours have one, progressive ones of others about ten
MAX_PICTURES = 3 * 2**29  # [bytes] of pictures that are decoded into one array
MAX_FRAMES = 100_000  # of one video; an episode of 100 minutes
MAX_BOXES = 10_000  # side by side in an MP4
LARGEST_MESSAGE = 2**24  # [bytes] of a policy server; a chunk of 50 actions has 6 kB
LONGEST_REPORT = 4000  # [characters] that are kept of an error from elsewhere
MAX_STALE = 100  # answers to abandoned requests that are skipped before the right one
