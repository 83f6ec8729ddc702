% Column under its own weight in AMPLE, GIMP; see column_on_grid in problems.py.
%
%    octave-cli --no-gui ample_column.m FOLDER CELLS STEPS
%
% FOLDER holds AMPLE 1.1 (https://wmcoombs.github.io), which is called, not copied. Prints error,
% processor time without the start of Octave, and memory as JSON.
given = argv();
folder = given{1};
n = str2double(given{2});
steps = str2double(given{3});
addpath(fullfile(folder, "functions"), fullfile(folder, "constitutive"), fullfile(folder, "setup"));

height = 50; weight = 80*10; per_cell = 2;
h = height/n;
[mesh.etpl, mesh.coord] = formCoord2D(1, n, h, height);
mesh.h = [h h];
sides = find(mesh.coord(:, 1) == 0 | mesh.coord(:, 1) == h);
base = find(mesh.coord(:, 2) == 0);
held = sort([2*sides - 1; 2*base]);
mesh.bc = [held, zeros(size(held))];

edge = h/per_cell;
points = struct([]);
for j = 1:per_cell*n
   for i = 1:per_cell
      point.mpType = 2; point.cmType = 1;
      point.mpC = ([i j] - 0.5)*edge;
      point.vp = edge^2; point.vp0 = edge^2; point.mpM = 80*edge^2;
      point.nIN = []; point.eIN = []; point.nSMe = 0; point.Svp = []; point.dSvp = [];
      point.Fn = eye(3); point.F = eye(3);
      point.sig = zeros(6, 1); point.epsEn = zeros(6, 1); point.epsE = zeros(6, 1);
      point.mCst = [1e4 0]; point.fp = zeros(2, 1); point.u = zeros(2, 1);
      point.lp = [edge edge]/2; point.lp0 = point.lp;
      points = [points, point];
   end
end
start = [points.mpC](2:2:end);

before = cputime();
n_dofs = 2*rows(mesh.coord);
for step = 1:steps
   [mesh, points] = elemMPinfo(mesh, points);
   load = detExtForce(rows(mesh.coord), 2, 10, points)*step/steps;
   free = detFDoFs(mesh);
   moved = zeros(n_dofs, 1); reaction = moved; unbalanced = load; stiffness = sparse(n_dofs, n_dofs);
   for iteration = 0:49
      [correction, change] = linSolve(mesh.bc, stiffness, unbalanced, iteration, free);
      moved += correction;
      reaction += change;
      [internal, stiffness, points] = detMPs(moved, points);
      unbalanced = load - internal + reaction;
      if iteration > 0 && norm(unbalanced) <= 1e-9*norm(load + reaction)
         break
      end
   end
   if iteration == 49
      error("AMPLE does not converge in step %d", step);
   end
   points = updateMPs(moved, points);
end
used = cputime() - before;

stress = [points.sig](2, :);
wrong = abs(stress + weight*(height - start));
error_of_stress = sum(wrong.*[points.vp0])/sum([points.vp0])/(weight*height);
peak = regexp(fileread("/proc/self/status"), 'VmHWM:\s*(\d+)', "tokens"){1}{1};
printf("RESULT{\"error\": %.6e, \"cpu\": %.4f, \"memory\": %d}\n", error_of_stress, used, ...
       1024*str2double(peak));
