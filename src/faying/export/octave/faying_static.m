function state = faying_static(joint, F, N0, before)
% Static state of the joint, the start of a simulation.
%
%   joint  load('compliance.mat')
%   F      forces and moments at the boundary, in the order of joint.boundary_names, then factors
%          of the loads joint.load_names, which may be left out; [] for none
%   N0     initial forces of the bolts; joint.N0, those of the preload, unless given
%   before the static state this one goes on from, of a joint with friction, whose answer depends on
%          the way; the unstressed joint unless given
%
%   state  fields q, v, a (n, 1); lambda, gap (n_point, 1); active; pressure is lambda ./ joint.w;
%          shear, slip (n_point, 2) along joint.tangents1 and joint.tangents2, zero without friction
  if nargin < 2
    F = [];
  end
  if nargin < 3
    N0 = joint.N0;
  end
  if nargin < 4
    before = faying_unstressed(joint);
  end
  f = faying_forces(joint, F) - joint.E' * N0(:);
  [U, failed] = chol(joint.K);
  if failed
    error('faying:static', 'K is singular: nothing holds the joint; hold it, or begin with faying_rest');
  end
  answers = U' \ joint.P';
  S = answers' * answers + joint.R;
  [state, pairs] = faying_close(S, joint, joint.P * (U \ (U' \ f)), before);
  state.q = U \ (U' \ (f + joint.P' * pairs));
  state.v = zeros(size(state.q));
  state.a = zeros(size(state.q));
end
