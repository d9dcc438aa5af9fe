function [state, pairs] = faying_close(S, joint, free, state)
% Contact at the end of a load or time step, from where the one before left it.
%
%   S      compliance between node pairs (n_relative, n_relative)
%   joint  load('compliance.mat')
%   free   displacements between the pairs without contact forces (n_relative, 1)
%   state  with the field active to start from, and with friction lambda, shear and slip
%
%   state  the same with new fields lambda, gap, active (n_point, 1), shear, slip (n_point, 2)
%   pairs  forces between the pairs (n_relative, 1)
  n = numel(joint.w);
  d = 1 ./ (joint.cn .* joint.w);
  gfree = joint.g0 + joint.N * free;
  if any(joint.mu > 0)
    zfree = [gfree; joint.T * free - state.slip(:)];
    [forces, slack] = faying_friction(S, joint, zfree, [state.lambda; state.shear(:)]);
    state.lambda = forces(1:n);
    state.shear = reshape(forces(n + 1:end), n, 2);
    state.slip = state.slip + reshape(slack(n + 1:end), n, 2);
    state.active = state.lambda > 0;
    state.gap = slack(1:n) - d .* state.lambda;
  else
    [state.lambda, slack, state.active] = faying_complementarity(S, joint.N, d, gfree, state.active);
    state.shear = zeros(n, 2);
    state.slip = zeros(n, 2);
    state.gap = slack - d .* state.lambda;
  end
  pairs = joint.N' * state.lambda + joint.T' * state.shear(:);
end
