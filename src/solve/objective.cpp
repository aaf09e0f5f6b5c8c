#include "pellicle/solve/objective.h"

#include <algorithm>
#include <set>

#include "pellicle/energies/geometry.h"

namespace pellicle {

std::vector<RowGroup> group_rows(const SampleLayout& layout, const std::vector<int>& start,
                                 const std::vector<int>& sample) {
  std::map<std::vector<int>, std::vector<int>> rows_of;  // ordered: groups come out the same every time
  for (std::size_t row = 0; row + 1 < start.size(); ++row) {
    std::vector<int> patches;
    for (auto k = static_cast<std::size_t>(start[row]); k < static_cast<std::size_t>(start[row + 1]); ++k) {
      patches.push_back(layout.patch_of[static_cast<std::size_t>(sample[k])]);
    }
    std::sort(patches.begin(), patches.end());
    patches.erase(std::unique(patches.begin(), patches.end()), patches.end());
    rows_of[patches].push_back(static_cast<int>(row));
  }
  std::vector<RowGroup> groups;
  for (auto& [patches, rows] : rows_of) {
    RowGroup group;
    group.patches = patches;
    group.rows = std::move(rows);
    std::set<int> blocks;
    for (const int p : patches) {
      const auto& of_patch = layout.patches[static_cast<std::size_t>(p)].blocks;
      blocks.insert(of_patch.begin(), of_patch.end());
    }
    group.blocks.assign(blocks.begin(), blocks.end());
    for (const int p : patches) {
      std::vector<int> slots;
      for (const int block : layout.patches[static_cast<std::size_t>(p)].blocks) {
        const auto at = std::lower_bound(group.blocks.begin(), group.blocks.end(), block);
        slots.push_back(static_cast<int>(at - group.blocks.begin()));
      }
      group.slots.push_back(std::move(slots));
    }
    groups.push_back(std::move(group));
  }
  return groups;
}

double GroupedOperator::energy(const std::vector<Vec3>& x) const {
  double total = 0.0;
  for (std::size_t r = 0; r < rows.size(); ++r) total += rows.residual(r, x).squaredNorm();
  return 0.5 * root_weight * root_weight * total;
}

GroupedOperator grouped_operator(std::string name, double weight, VectorRows rows, const SampleLayout& layout) {
  GroupedOperator op;
  op.name = std::move(name);
  op.root_weight = std::sqrt(weight);
  if (!layout.stencils) op.groups = group_rows(layout, rows.start, rows.sample);
  op.rows = std::move(rows);
  return op;
}

double NamedRows::energy(const std::vector<Vec3>& x) const {
  double total = 0.0;
  for (std::size_t r = 0; r < rows.size(); ++r) {
    const double residual = rows.residual(r, x);
    total += residual * residual;
  }
  return 0.5 * total;
}

std::map<std::string, double> energies_at(const StepProblem& problem, const std::vector<Vec3>& x) {
  std::map<std::string, double> energies;
  for (const auto& op : *problem.operators) energies[op.name] += op.energy(x);
  for (const auto& rows : problem.rows) energies[rows.name] += rows.energy(x);
  if (!problem.scalars.empty()) {
    const std::vector<Vec3> area = area_vectors(*problem.layout, x);
    std::vector<Vec3> ignored_x(x.size(), Vec3::Zero()), ignored_a(x.size(), Vec3::Zero());
    for (const auto& scalar : problem.scalars) energies[scalar.name] += scalar.evaluate(x, area, ignored_x, ignored_a);
  }
  return energies;
}

}  // namespace pellicle
