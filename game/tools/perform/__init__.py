"""Performs the seven takes procedurally: scores + effort -> BVH and annotations, as a recorded actor would give."""

from game.tools.perform.take import Annotation, Span, annotation_yaml, build_takes, perform_score, perform_take

__all__ = ["Annotation", "Span", "annotation_yaml", "build_takes", "perform_score", "perform_take"]
