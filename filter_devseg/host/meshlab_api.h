// The parts of MeshLab that are the same in all its versions, at the places where each keeps them.
#pragma once

#if __has_include(<common/ml_document/mesh_document.h>)
#include <common/ml_document/mesh_document.h>
#include <common/parameters/rich_parameter_list.h>
#else // before 2021
#include <common/filter_parameter/rich_parameter_list.h>
#include <common/meshmodel.h>
#endif

// Its name before 2023.
#if __has_include(<common/parameters/rich_parameter/rich_file_save.h>)
using RichSaveFile = RichFileSave;
#endif
