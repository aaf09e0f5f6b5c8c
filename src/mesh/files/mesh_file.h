#pragma once
/// Mesh files. PLY, OBJ, STL and VTP hold LPS mm and say so where the format has a place for it ("SPACE=LPS", as 3D
/// Slicer writes); GIfTI (.surf.gii) holds RAS, as its readers expect. Reading turns it back.

#include <filesystem>
#include <string>

#include "pellicle/mesh/triangle_mesh.h"

namespace pellicle {

enum class MeshFormat { ply, stl, obj, vtp, gii };

/// From "ply", "stl", "obj", "vtp", "gii".
/// \throws UsageError naming the choices.
MeshFormat mesh_format_from_name(const std::string& name);
/// By extension.
/// \throws the same.
MeshFormat mesh_format_of_path(const std::filesystem::path& path);
/// ".ply", ".stl", ".obj", ".vtp", ".surf.gii".
std::string extension_of(MeshFormat format);

/// Atomic; binary PLY (double) and STL, ascii OBJ, VTP with appended/base64 data, GIfTI base64 (gzip).
/// \throws CannotCreate, IoError.
void write_mesh(const std::filesystem::path& path, const TriangleMesh& mesh, MeshFormat format);

/// By extension: .ply (ascii, binary), .stl (both; equal vertices merged), .obj, .off, .vtp, .gii. Polygons are
/// fanned into triangles.
/// \throws NoInput, BadData.
TriangleMesh read_mesh(const std::filesystem::path& path);

}  // namespace pellicle
