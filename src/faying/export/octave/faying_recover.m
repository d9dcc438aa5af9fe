function [pressure, gap, lambda, displacement, state] = faying_recover(joint, v, a, F, N0, before)
% Pressures of the full model at one instant, whatever program simulated the motion.
%
%   joint  load('compliance.mat')
%   v, a   first and second time derivative of the generalized coordinates (n, 1); zero in statics
%   F      loads at that instant, as for faying_static
%   N0     initial forces of the bolts; joint.N0 unless given, and where it is []
%   before with friction, the state recovered at the instant before, at first that of the motion:
%          its fields lambda, shear and slip
%
%   pressure, gap, lambda  at every contact point
%   displacement           at the boundary, as joint.boundary_names
%   state                  fields lambda, gap, active, shear, slip: contact there
%
% The static contact problem of the full model under the loads and the inertia and damping forces
% of the motion (mode acceleration with contact).
  if nargin < 5 || isempty(N0)
    N0 = joint.N0;
  end
  if nargin < 6
    if any(joint.mu > 0)
      error('faying:friction', ['what is recovered with friction depends on the instants before; ' ...
        'give the state of the last one, faying_recover(joint, v, a, F, N0, before)']);
    end
    before = faying_unstressed(joint);
  end
  n_relative = size(joint.N, 2);
  pairs = 1:n_relative;
  [~, at_boundary, factors] = faying_forces(joint, F);
  outer = [at_boundary; -N0(:); factors];
  free = joint.recovery_compliance(:, n_relative + 1:end) * outer ...
    - joint.recovery_inertia * a(:) - joint.recovery_damping * v(:);
  S = joint.recovery_compliance(pairs, pairs);
  [state, forces] = faying_close(S, joint, free(pairs), before);
  [lambda, gap] = deal(state.lambda, state.gap);
  pressure = lambda ./ joint.w;
  ports = free + joint.recovery_compliance(:, pairs) * forces;
  displacement = ports(n_relative + (1:numel(joint.boundary)));
end
