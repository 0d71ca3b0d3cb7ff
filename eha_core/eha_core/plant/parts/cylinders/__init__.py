"""What turns pressure into motion."""
