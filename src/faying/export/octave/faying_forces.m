function [f, at_boundary, factors] = faying_forces(joint, F)
% Forces of loads on the generalized coordinates.
%
%   joint  load('compliance.mat')
%   F      forces and moments at the boundary, in the order of joint.boundary_names, then factors
%          of the loads joint.load_names, which may be left out; [] for none
%
%   f            forces on the coordinates (n, 1)
%   at_boundary  forces and moments at the boundary
%   factors      of the loads
  n_boundary = numel(joint.boundary);
  n_load = numel(joint.load_names);
  given = F(:);
  if isempty(given)
    given = zeros(n_boundary, 1);
  end
  if numel(given) == n_boundary
    given = [given; zeros(n_load, 1)];
  end
  if numel(given) ~= n_boundary + n_load
    error('faying:loads', 'found %d loads, expected %d at the boundary and then %d factors', ...
      numel(F), n_boundary, n_load);
  end
  at_boundary = given(1:n_boundary);
  factors = given(n_boundary + 1:end);
  f = zeros(size(joint.K, 1), 1);
  f(joint.boundary) = at_boundary;
  if n_load > 0
    f = f + joint.L' * factors;
  end
end
