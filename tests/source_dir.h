#pragma once
/// The folder of the project's sources, for tests that read files from it. Included into every test.

const char* pellicle_source_dir();
#define PELLICLE_SOURCE_DIR pellicle_source_dir()
