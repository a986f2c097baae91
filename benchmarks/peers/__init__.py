"""Other ways to compute the same motions, each as its user would write it; `benchmarks/tables.py` compares them."""
