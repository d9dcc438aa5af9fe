function [forces, slack, jacobian] = faying_friction(S, joint, free, start)
% Contact forces with Coulomb friction after one increment.
%
%   S      compliance between node pairs (n_relative, n_relative)
%   joint  load('compliance.mat')
%   free   gaps, then tangential displacements less the slip so far along the first and along the
%          second tangents, all without contact forces (3 n_point, 1)
%   start  forces to begin with, those of the increment before (3 n_point, 1)
%
%   forces    normal ones, then those along the first and along the second tangents
%   slack     z = G S G' forces + d .* forces + free with G = [N; T]; its tangential part is the
%             slip of the increment
%   jacobian  change of the forces between pairs, G' forces, per displacement between them
%             (n_relative, n_relative), unsymmetric where points slip
%
% Solves  forces = admissible(forces - r .* z),  the normal force cut to what presses and the
% tangential one to mu times that, by a semismooth Newton method with its exact derivative. Steps
% are halved until what is left falls; where that stops, it may rise between five steps, from there
% and from contact without friction.
  n = numel(joint.w);
  G = [joint.N; joint.T];
  d = [1 ./ (joint.cn .* joint.w); repmat(1 ./ (joint.ct .* joint.w), 2, 1)];
  own = reshape(full(sum((G * S) .* G, 2)), n, 3);
  own(:, 2:3) = repmat(mean(own(:, 2:3), 2), 1, 2);
  total = own + reshape(d, n, 3);
  r = ones(n, 3);
  r(total > 0) = 1 ./ total(total > 0);
  r(:, 2:3) = 10 * r(:, 2:3);
  problem = struct('S', S, 'G', G, 'd', d, 'r', r, 'mu', joint.mu, 'free', free, ...
    'give', max(d, 1e-8 * own(:)));
  [forces, left] = newton(problem, start(:), 1);
  if left > 1e-9
    [forces, left] = newton(problem, forces, 5);
  end
  if left > 1e-9
    smooth = faying_complementarity(S, joint.N, d(1:n), free(1:n), []);
    [forces, left] = newton(problem, [smooth; zeros(2 * n, 1)], 5);
  end
  if left > 1e-9
    error('faying:friction', ['an increment with friction was not solved (%.1e of the largest ' ...
      'force is left); take smaller increments, or a smaller coefficient of friction'], left);
  end
  slack = displaced(problem, forces);
  if nargout > 2
    [~, at] = residual(problem, forces, slack);
    [~, K] = locally(problem, at, zeros(3 * n, 1), d);
    B = full(G' * K * G);
    jacobian = -((eye(size(S)) + B * S) \ B);
  end
end

function z = displaced(problem, x)
  z = problem.G * (problem.S * (problem.G' * x)) + problem.d .* x + problem.free;
end

function [F, at] = residual(problem, x, z)
% What is left of the law, and where forces are: closed, slipping, held to a share, pulled along t.
  n = numel(problem.mu);
  tried = reshape(x - problem.r(:) .* z, n, 3);
  normal = max(tried(:, 1), 0);
  limit = problem.mu .* normal;
  len = hypot(tried(:, 2), tried(:, 3));
  at.closed = normal > 0;
  at.slips = len > limit | limit <= 0;
  at.t = tried(:, 2:3) ./ max(len, realmin);
  at.held = ones(n, 1);
  at.held(at.slips) = limit(at.slips) ./ max(len(at.slips), realmin);
  F = x - [normal; at.held .* tried(:, 2); at.held .* tried(:, 3)];
end

function [dx, K] = locally(problem, at, F, give)
% Solve A dx + E dy = -F at every point for dy = 0, and return K = A \ E, with the derivative J of
% the admissible forces, E = J r and A = I - J + E give.
  n = numel(problem.mu);
  give = reshape(give, n, 3);
  F = reshape(F, n, 3);
  r1 = problem.r(:, 1);
  r2 = problem.r(:, 2);
  closed = double(at.closed);
  slips = double(at.slips);
  a1 = 1 - closed + closed .* r1 .* give(:, 1);
  k1 = closed .* r1 ./ a1;
  along = 1 - slips;               % derivative along the tangential force, and across it
  across = at.held;
  rest = 1 - r2 .* give(:, 2);
  pulled = problem.mu .* closed .* slips;
  t = at.t;
  u = [-t(:, 2), t(:, 1)];
  over = [1 ./ (1 - rest .* along), 1 ./ (1 - rest .* across)];
  first = -F(:, 1) ./ a1;
  right = -F(:, 2:3) - (pulled .* (r1 .* give(:, 1) - 1) .* first) .* t;
  second = (over(:, 1) .* sum(right .* t, 2)) .* t + (over(:, 2) .* sum(right .* u, 2)) .* u;
  dx = [first; second(:)];
  kt = r2 .* along .* over(:, 1);
  ku = r2 .* across .* over(:, 2);
  down = pulled .* (r1 + (1 - r1 .* give(:, 1)) .* k1) .* over(:, 1);
  p = (1:n)';
  one = kt .* t(:, 1).^2 + ku .* u(:, 1).^2;
  two = kt .* t(:, 2).^2 + ku .* u(:, 2).^2;
  mixed = kt .* t(:, 1) .* t(:, 2) + ku .* u(:, 1) .* u(:, 2);
  K = sparse([p; p + n; p + 2 * n; p + n; p + 2 * n; p + n; p + 2 * n], ...
    [p; p; p; p + n; p + 2 * n; p + 2 * n; p + n], ...
    [k1; down .* t(:, 1); down .* t(:, 2); one; two; mixed; mixed], 3 * n, 3 * n);
end

function [x, left] = newton(problem, x, watched)
  z = displaced(problem, x);
  [F, at] = residual(problem, x, z);
  norms = norm(F);
  if watched > 1
    norms = 1e3 * norms;
  end
  left = relative(F, x);
  for iteration = 1:60
    if left <= 1e-13
      return
    end
    dx = direction(problem, at, F);
    if any(~isfinite(dx))
      return
    end
    part = 1;
    found = false;
    for halving = 1:12
      tried = x + part * dx;
      z = displaced(problem, tried);
      [Ft, att] = residual(problem, tried, z);
      if norm(Ft) < (1 - 1e-4 * part) * max(norms(max(1, end - watched + 1):end))
        found = true;
        break
      end
      part = part / 2;
    end
    if ~found
      return
    end
    x = tried;
    F = Ft;
    at = att;
    norms(end + 1) = norm(F);
    left = relative(F, x);
  end
end

function dx = direction(problem, at, F)
% With the change q of the forces between pairs (I + B S) q = G' dx_local, B = G' K G.
  [dx, K] = locally(problem, at, F, problem.give);
  B = problem.G' * K * problem.G;
  q = problem.G' * dx;
  touched = any(B, 1)' | any(B, 2);
  beside = q;
  beside(touched) = 0;
  Bt = full(B(touched, :));
  M = eye(nnz(touched)) + Bt(:, touched) * problem.S(touched, touched);
  q(touched) = M \ (q(touched) - Bt * (problem.S * beside));
  dx = dx - K * (problem.G * (problem.S * q));
end

function left = relative(F, x)
  worst = max(abs(F));
  left = worst / max([max(abs(x)), worst, realmin]);
end
