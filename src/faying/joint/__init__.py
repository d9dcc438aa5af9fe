"""Joints: structure and contact together, the common basis of full and reduced models."""
