"""Every equation, and what each result was compared with."""
