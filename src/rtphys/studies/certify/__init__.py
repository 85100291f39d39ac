"""`certify`: finding the seeds on which policies are evaluated."""
