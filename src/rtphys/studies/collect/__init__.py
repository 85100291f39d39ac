"""`collect`: a dataset of accepted episodes, in parts if need be, and what it will take."""
