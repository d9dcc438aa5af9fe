"""From a study file to results, in rooms that import only from those before them.

``keys`` (the file and what it must be), ``inputs`` (model and loads), ``results`` (what a run
leaves), ``judgement`` (what that is worth), ``stages`` (the steps of a run).
"""
