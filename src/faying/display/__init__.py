"""Values as text, as notebook tables, and on plot axes."""
