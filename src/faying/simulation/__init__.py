"""Stage 4: static and transient solutions of full and reduced models alike."""
