function state = faying_step(joint, state, F, h, N0)
% One step of implicit Euler with contact at its end.
%
%   joint  load('compliance.mat')
%   state  of faying_static or of the step before; with friction what has slipped goes on from it
%   F      loads at the end of the step, as for faying_static
%   h      time step; the factorization is kept in state.step as long as h stays the same
%   N0     initial forces of the bolts; joint.N0 unless given
%
%   (M/h^2 + C/h + K) q1 = f + P' pairs + M (q/h^2 + v/h) + C q/h
  if nargin < 5
    N0 = joint.N0;
  end
  if ~isfield(state, 'step') || state.step.h ~= h
    A = joint.M / h^2 + joint.C / h + joint.K;
    state.step.h = h;
    state.step.U = chol((A + A') / 2);
    answers = state.step.U' \ joint.P';
    state.step.S = answers' * answers + joint.R;
  end
  U = state.step.U;
  b = faying_forces(joint, F) - joint.E' * N0(:);
  b = b + joint.M * (state.q / h^2 + state.v / h) + joint.C * (state.q / h);
  [state, pairs] = faying_close(state.step.S, joint, joint.P * (U \ (U' \ b)), state);
  q = U \ (U' \ (b + joint.P' * pairs));
  v = (q - state.q) / h;
  state.a = (v - state.v) / h;
  state.v = v;
  state.q = q;
end
