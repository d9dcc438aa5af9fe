function [f, J, lambda, gap, state] = faying_contact(joint, q, before)
% Contact forces in the generalized coordinates at a displacement q, and their jacobian.
%
%   joint   load('compliance.mat'), see docs/how-to/export_to_matlab.md of faying
%   q       generalized coordinates (n, 1)
%   before  points in contact to start from (logical), optional; with friction the state at the end
%           of the step before: its fields lambda, shear and slip
%
%   f       forces (n, 1) to be added to the right-hand side of M q'' + C q' + K q = F
%   J       df/dq (n, n), symmetric and negative semidefinite; with friction unsymmetric where
%           points slip
%   lambda  contact force at every point; pressure is lambda ./ joint.w
%   gap     gap at every point, below zero by the penetration a penalty admits
%   state   fields lambda, gap, active, shear, slip: where contact stands, to go on from with
%           friction once a step is accepted
  rubs = any(joint.mu > 0);
  if nargin < 3
    if rubs
      error('faying:friction', ['friction depends on what has slipped before; give the state of ' ...
        'the step before, faying_contact(joint, q, before)']);
    end
    before = [];
  end
  if ~isstruct(before)
    active = before;
    before = faying_unstressed(joint);
    before.active = active;
  end
  d = 1 ./ (joint.cn .* joint.w);
  if any(d == 0) && ~any(joint.R(:))
    error('faying:contact', ['hard contact has no force for a given q where the model keeps no ' ...
      'residual compliance; use faying_static and faying_step, or export the method compliance']);
  end
  [state, pairs] = faying_close(joint.R, joint, joint.P * q, before);
  [lambda, gap, active] = deal(state.lambda, state.gap, state.active);
  f = joint.P' * pairs;
  J = zeros(numel(q));
  if rubs
    if any(1 ./ joint.ct(joint.mu > 0) == 0) || any(d == 0)
      error('faying:friction', ['rigid points with friction have no jacobian; give the interface ' ...
        'a penalty and a tangential penalty, or use faying_step']);
    end
    zfree = [joint.g0; -before.slip(:)] + [joint.N; joint.T] * (joint.P * q);
    [~, ~, between] = faying_friction(joint.R, joint, zfree, [lambda; state.shear(:)]);
    J = joint.P' * between * joint.P;
  elseif any(active)
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
