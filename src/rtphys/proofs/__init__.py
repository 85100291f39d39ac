"""One experiment for each attribute, with a textbook outcome; the tests and `prove` run them."""
