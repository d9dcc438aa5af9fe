"""Where two surfaces meet: facets, pairs, projections and the operators they give."""
