function state = faying_rest(joint)
% The joint at rest under the bolt forces joint.N0: where a joint begins that nothing holds.
%
%   joint  load('compliance.mat')
%   state  as of faying_static
  still = zeros(size(joint.q0));
  pairs = joint.N' * joint.lambda0 + joint.T' * joint.shear0(:);
  state = struct('q', joint.q0, 'v', still, 'a', still, 'lambda', joint.lambda0, ...
                 'gap', joint.g0 + joint.N * (joint.P * joint.q0 + joint.R * pairs), ...
                 'active', joint.lambda0 > 0, 'shear', joint.shear0, 'slip', joint.slip0);
end
