"""What every tool's window shares: ImGui on moderngl, fonts and colours."""
