#pragma once
/// The sections of the accuracy table. Each prints its own table (markdown) to stdout.

#include <filesystem>
#include <string>

#include "pellicle/fit/fit.h"

namespace pellicle::bench {

struct Options {
  std::filesystem::path data;     ///< folder with the real volumes (sarcoma, bad-and-odd); may be absent
  std::filesystem::path head;     ///< folder of ch2.nii.gz and ch2bet.nii.gz
  std::filesystem::path scratch;  ///< for files of the runs; removed afterwards
  int seeds = 8;                  ///< a phantom case
  std::string only;               ///< a phantom shape, or empty for all
  ModelChoice model;              ///< of the phantoms, the sphere and the brain
};

void phantom_table(const Options& options);
void unseeded_table(const Options& options);
void clean_sphere_table(const Options& options);
void torus_table(const Options& options);
void handle_table(const Options& options);
void points_table(const Options& options);
void power_table(const Options& options);
void nuclei_table(const Options& options);
void brain_table(const Options& options);
void sarcoma_table(const Options& options);
void organ_table(const Options& options);
void hippocampus_table(const Options& options);
void open_table(const Options& options);
void shape_table(const Options& options);
void storage_order_table(const Options& options);
void speed_table(const Options& options);
void thread_table(const Options& options);
void solver_table();
void flux_table();

double seconds_now();
/// Mesh for measuring: facets of about 0.7 h.
TriangleMesh measuring_mesh(const Surface& surface, double h);

}  // namespace pellicle::bench
