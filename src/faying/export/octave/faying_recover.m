function [pressure, gap, lambda, displacement] = faying_recover(joint, v, a, F, N0)
% Pressures of the full model at one instant, whatever program simulated the motion.
%
%   joint  load('compliance.mat')
%   v, a   first and second time derivative of the generalized coordinates (n, 1); zero in statics
%   F      loads at that instant, as for faying_static
%   N0     initial forces of the bolts; joint.N0 unless given
%
%   pressure, gap, lambda  at every contact point
%   displacement           at the boundary, as joint.boundary_names
%
% The static contact problem of the full model under the loads and the inertia and damping forces
% of the motion (mode acceleration with contact).
  if nargin < 5
    N0 = joint.N0;
  end
  [n_point, n_relative] = size(joint.N);
  pairs = 1:n_relative;
  [~, at_boundary, factors] = faying_forces(joint, F);
  outer = [at_boundary; -N0(:); factors];
  free = joint.recovery_compliance(:, n_relative + 1:end) * outer ...
    - joint.recovery_inertia * a(:) - joint.recovery_damping * v(:);
  d = 1 ./ (joint.cn .* joint.w);
  S = joint.recovery_compliance(pairs, pairs);
  gfree = joint.g0 + joint.N * free(pairs);
  [lambda, slack] = faying_complementarity(S, joint.N, d, gfree, []);
  gap = slack - d .* lambda;
  pressure = lambda ./ joint.w;
  ports = free + joint.recovery_compliance(:, pairs) * (joint.N' * lambda);
  displacement = ports(n_relative + (1:numel(joint.boundary)));
end
