function [f, J, lambda, gap] = faying_contact(joint, q, active)
% Contact forces in the generalized coordinates at a displacement q, and their jacobian.
%
%   joint   load('compliance.mat'), see docs/how-to/export_to_matlab.md of faying
%   q       generalized coordinates (n, 1)
%   active  points in contact to start from (logical), optional
%
%   f       G' * lambda (n, 1), to be added to the right-hand side of M q'' + C q' + K q = F
%   J       df/dq (n, n), symmetric and negative semidefinite
%   lambda  contact force at every point; pressure is lambda ./ joint.w
%   gap     gap at every point, below zero by the penetration a penalty admits
  if nargin < 3
    active = [];
  end
  d = 1 ./ (joint.cn .* joint.w);
  if any(d == 0) && ~any(joint.R(:))
    error('faying:contact', ['hard contact has no force for a given q where the model keeps no ' ...
      'residual compliance; use faying_static and faying_step, or export the method compliance']);
  end
  gfree = joint.g0 + joint.G * q;
  [lambda, slack, active] = faying_complementarity(joint.R, joint.N, d, gfree, active);
  gap = slack - d .* lambda;
  f = joint.G' * lambda;
  J = zeros(numel(q));
  if any(active)
    Na = joint.N(active, :);
    H = full(Na * joint.R * Na') + diag(d(active));
    Ga = joint.G(active, :);
    if any(d(active) == 0)
      J = -Ga' * (pinv(H) * Ga);
    else
      J = -Ga' * (H \ Ga);
    end
    J = (J + J') / 2;
  end
end
