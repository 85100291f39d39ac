"""The scripted expert: verbs of both arms, planned, checked and carried out."""
