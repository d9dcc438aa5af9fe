"""What results are worth: errors, warnings, verdicts, and the summary that says them."""
