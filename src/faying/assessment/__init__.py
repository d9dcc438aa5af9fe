"""Assessment of solutions: errors, certificates, recovery, sensitivities, strength, advice."""
