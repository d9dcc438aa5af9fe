function [lambda, slack, active] = faying_complementarity(S, N, d, gfree, active)
% Contact forces of  s = (N S N' + diag(d)) lambda + gfree >= 0,  lambda >= 0,  lambda' s = 0.
%
%   S       compliance between node pairs (n_relative, n_relative)
%   N       interpolation to the contact points (n_point, n_relative), sparse
%   d       compliance of the contact law at each point, 1 ./ (cn .* w); zero where contact is hard
%   gfree   gaps without contact forces
%   active  where to start (logical), for instance the last result; [] for gfree < 0
%
% Primal-dual active set with single exchanges by Murty's rule as backup. Where hard contact makes
% the matrix singular, the proximal point method from lambda = 0 picks the forces of a very stiff
% contact law. The same steps as faying takes.
  if isempty(active)
    active = gfree < 0;
  end
  own = full(sum((N * S) .* N, 2)) + d;
  [lambda, slack, active, ok] = pivot(S, N, d, own, gfree, logical(active(:)));
  if ok
    return
  end
  delta = 1e-7 * max(own);
  start = active;
  lambda = zeros(size(gfree));
  for k = 1:200
    [new, slack, start, ok] = pivot(S, N, d + delta, own + delta, gfree - delta * lambda, start);
    if ~ok
      break
    end
    residual = delta * max(abs(new - lambda));
    lambda = new;
    if residual <= max(round_off(own, gfree, lambda))
      active = start;
      slack = max(N * (S * (N' * lambda)) + d .* lambda + gfree, 0);
      return
    end
  end
  error('faying:contact', ['hard contact at %d points could not be closed; a model with residual ' ...
    'compliance (method compliance), nodal quadrature or a penalty helps'], numel(gfree));
end

function [lambda, slack, active, ok] = pivot(S, N, d, own, gfree, active)
  n = numel(gfree);
  fewest = n + 1;
  attempts = 20;
  for iteration = 1:(50 * n + 200)
    [lambda, slack, ok] = equilibrate(S, N, d, gfree, active);
    if ~ok
      return
    end
    noise = round_off(own, gfree, lambda);
    wrong = (active & own .* lambda < -noise) | (~active & slack < -noise);
    count = sum(wrong);
    if count == 0
      lambda = max(lambda, 0);
      slack = max(slack, 0);
      return
    end
    if count < fewest
      fewest = count;
      attempts = 20;
      active = xor(active, wrong);
    elseif attempts > 0
      attempts = attempts - 1;
      active = xor(active, wrong);
    else
      last = find(wrong, 1, 'last');
      active(last) = ~active(last);
    end
  end
  error('faying:contact', 'the contact problem of %d points did not settle', n);
end

function noise = round_off(own, gfree, lambda)
% What it makes of gaps that vanish; the rigid motion of a part on weak springs moves by far more.
  root = sqrt(max(own, 0));
  noise = max(eps * (root' * abs(lambda)) * root, 1e-13 * max([abs(gfree); 0]));
end

function [lambda, slack, ok] = equilibrate(S, N, d, gfree, active)
  lambda = zeros(size(gfree));
  slack = gfree;
  ok = true;
  if ~any(active)
    return
  end
  Na = N(active, :);
  H = full(Na * S * Na') + diag(d(active));
  [U, failed] = chol((H + H') / 2);
  if failed || min(diag(U)) < 1e-7 * max(diag(U))
    ok = false;
    return
  end
  lambda(active) = -(U \ (U' \ gfree(active)));
  slack = N * (S * (N' * lambda)) + d .* lambda + gfree;
  slack(active) = 0;
end
