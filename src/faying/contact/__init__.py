"""Contact of the parts, formulated and solved as a complementarity problem (stage 2)."""
