"""What judges a solution: errors, certificates, recovery, sensitivities, advice."""
