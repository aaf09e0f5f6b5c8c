#pragma once
/// Models as JSON (schema: docs/model.schema.json). Doubles are written so that they read back to the same bits.

#include <filesystem>

#include "pellicle/surface/surface.h"

namespace pellicle {

/// The file appears whole or not at all: {"format": "pellicle-model", "version": 1, "model": "normal", "rule": ...,
/// "frame": "LPS", "unit": "mm", "triangles": [[..]], "points": [[x,y,z]..], "normals": [..], "reference": {"points":,
/// "normals":}}.
/// \throws CannotCreate, IoError.
void write_model(const std::filesystem::path& path, const Surface& surface);
/// \throws NoInput, BadData naming the key and the rule it breaks.
Surface read_model(const std::filesystem::path& path);

}  // namespace pellicle
