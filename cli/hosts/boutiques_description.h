#pragma once
/// `pellicle segment` as a Boutiques tool, from the one table of settings.

#include <nlohmann/json_fwd.hpp>

namespace pellicle {

/// A descriptor of schema version 0.5: command line, inputs, groups of seeds that exclude each other, output files and
/// exit codes. `name` is required there, because the paths of the outputs are made of it.
nlohmann::ordered_json boutiques_description();

}  // namespace pellicle
