"""From a study file to results, in packages that import only from those before them.

``keys`` (the file and its rules), ``inputs`` (model and loads), ``results`` (values and files of
a run), ``judgement`` (errors, warnings and verdicts), ``stages`` (the steps of a run).
"""
