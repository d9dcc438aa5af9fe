function state = faying_static(joint, F, N0)
% Static state of the joint, the start of a simulation.
%
%   joint  load('compliance.mat')
%   F      forces and moments at the boundary, in the order of joint.boundary_names, then factors
%          of the loads joint.load_names, which may be left out; [] for none
%   N0     initial forces of the bolts; joint.N0, those of the preload, unless given
%
%   state  fields q, v, a (n, 1); lambda, gap (n_point, 1); active; pressure is lambda ./ joint.w
  if nargin < 2
    F = [];
  end
  if nargin < 3
    N0 = joint.N0;
  end
  f = faying_forces(joint, F) - joint.E' * N0(:);
  [U, failed] = chol(joint.K);
  if failed
    error('faying:static', 'K is singular: the joint is not held; hold it, or use faying_step');
  end
  d = 1 ./ (joint.cn .* joint.w);
  answers = U' \ joint.P';
  S = answers' * answers + joint.R;
  gfree = joint.g0 + joint.G * (U \ (U' \ f));
  [lambda, slack, active] = faying_complementarity(S, joint.N, d, gfree, []);
  state.q = U \ (U' \ (f + joint.G' * lambda));
  state.v = zeros(size(state.q));
  state.a = zeros(size(state.q));
  state.lambda = lambda;
  state.gap = slack - d .* lambda;
  state.active = active;
end
