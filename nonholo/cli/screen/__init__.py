"""The view of the user: errors in words, figures, pictures."""
