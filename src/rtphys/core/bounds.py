"""Bounds on what is read from files that others may have written; no other module sets one."""

NAME_BYTES = 200  # of a task, a configuration, a protocol; a file system takes 255
FILE_BYTES = 2**29  # of a file that is read as a whole, such as a journal or a video
JSON_BYTES = 2**28  # of a JSON document; a manifest has about 1 kB an episode
JSON_ITEMS = 10_000_000  # commas and brackets of a document: about 1.5 GB of Python objects
JSON_DEPTH = 64  # deepest of our own files: 9
YAML_BYTES = 2**20  # longest of our own files: 20 kB
YAML_NODES = 60_000  # a list of 10,000 instances has 50,000; all of it takes half a second
YAML_DEPTH = 32
YAML_ALIASES = 8  # they multiply: 8 make at most 18 times as many values; our own files have none
WHOLE_NUMBER = 2**63 - 1  # numpy's largest; also of a seed
EPISODES = 10_000_000  # of a task, and attempts
SHARDS = 10_000
SHOWN_CHARACTERS = 400  # characters of a value that an error shows
LARGEST_EPISODE = 2**32  # [bytes] of an HDF5 file; 200 frames of three 320x240 depths: 0.4e9
LARGEST_VIDEO = 2**28  # [bytes] of an MP4
MOST_LINKS = 1024  # names in an HDF5 file; an episode has 60 to 150
DEEPEST_LINK = 8  # names in a path of an HDF5 file; an episode has 3
MOST_PIXELS = 2**22  # of one picture or video frame, 2048x2048
MOST_SCANS = 16  # of one JPEG; ours have one, progressive ones of others about ten
MOST_PICTURES = 3 * 2**29  # [bytes] of pictures that are decoded into one array
MOST_FRAMES = 100_000  # of one video; an episode of 100 minutes
MOST_BOXES = 10_000  # side by side in an MP4
LARGEST_MESSAGE = 2**24  # [bytes] of a policy server; a chunk of 50 actions has 6 kB
LONGEST_SIGNATURE = 2**16  # [bytes] of a manifest's SSH signature; ours have 300 to 1,200
LONGEST_REPORT = 4000  # [characters] that are kept of an error from elsewhere
MOST_STALE = 100  # answers to abandoned requests that are skipped before the right one
