// Accuracy and speed, as tables: bench_accuracy [section ...] with sections phantoms, sphere, unseeded, brain, sarcoma,
// organs, hippocampus, open, shapes, orders, torus, handles, points, power, nuclei, speed, threads, solvers, flux
// (default: all). Options: --data DIR, --head DIR, --seeds N, --shape NAME, --model NAME (of the phantoms, the sphere
// and the brain).

#include <fmt/format.h>

#include <chrono>
#include <cstdlib>
#include <exception>
#include <map>
#include <vector>

#include "sections.h"

namespace pellicle::bench {

double seconds_now() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

TriangleMesh measuring_mesh(const Surface& surface, double h) {
  return tessellate(surface, tessellation_level(surface, 0.7 * h));
}

namespace {

ModelKind kind_named(const std::string& name) {
  for (const ModelKind kind : {ModelKind::normal, ModelKind::spline, ModelKind::catmull_clark, ModelKind::slime}) {
    if (model_name(start_model({.kind = kind})) == name) return kind;
  }
  throw std::runtime_error("unknown model " + name);
}

}  // namespace

}  // namespace pellicle::bench

int main(int argc, char** argv) try {
  using namespace pellicle::bench;
  Options options;
  const char* shared = std::getenv("PELLICLE_SHARED");
  options.data = shared != nullptr ? std::filesystem::path(shared) / "data" : "../shared/data";
  options.head = "/usr/share/mricron/templates";
  options.scratch = std::filesystem::temp_directory_path() / "pellicle-bench";
  std::vector<std::string> wanted;
  for (int i = 1; i < argc; ++i) {
    const std::string word = argv[i];
    const auto value = [&] {
      return i + 1 < argc ? std::string(argv[++i]) : throw std::runtime_error(word + " needs a value");
    };
    if (word == "--data")
      options.data = value();
    else if (word == "--head")
      options.head = value();
    else if (word == "--seeds")
      options.seeds = std::stoi(value());
    else if (word == "--shape")
      options.only = value();
    else if (word == "--model")
      options.model.kind = kind_named(value());
    else
      wanted.push_back(word);
  }
  const std::vector<std::pair<std::string, void (*)(const Options&)>> sections{
      {"sphere", clean_sphere_table},
      {"phantoms", phantom_table},
      {"unseeded", unseeded_table},
      {"torus", torus_table},
      {"handles", handle_table},
      {"points", points_table},
      {"power", power_table},
      {"nuclei", nuclei_table},
      {"brain", brain_table},
      {"sarcoma", sarcoma_table},
      {"organs", organ_table},
      {"hippocampus", hippocampus_table},
      {"open", open_table},
      {"shapes", shape_table},
      {"orders", storage_order_table},
      {"speed", speed_table},
      {"threads", thread_table},
      {"solvers", [](const Options&) { solver_table(); }},
      {"flux", [](const Options&) { flux_table(); }}};
  std::filesystem::create_directories(options.scratch);
  for (const auto& [name, run] : sections) {
    if (wanted.empty() || std::find(wanted.begin(), wanted.end(), name) != wanted.end()) run(options);
  }
  std::filesystem::remove_all(options.scratch);
  return 0;
} catch (const std::exception& e) {
  fmt::print(stderr, "bench_accuracy: {}\n", e.what());
  return 1;
}
