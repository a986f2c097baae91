"""What a person sees: errors in words, figures, pictures."""
