"""One experiment per attribute, each with a textbook outcome; shared by the tests and `prove`."""
