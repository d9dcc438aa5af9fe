function state = faying_unstressed(joint)
% Contact of the joint before its bolts are tightened: no force, no slip.
%
%   joint  load('compliance.mat')
  n = numel(joint.w);
  state = struct('lambda', zeros(n, 1), 'shear', zeros(n, 2), 'slip', zeros(n, 2), 'active', []);
end
