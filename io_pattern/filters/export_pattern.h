// Texture coordinates → the bytes of a pattern file, from end to end.
#pragma once

#include <string>
#include <vector>

#include "devseg/atlas/texture.h"
#include "devseg/base/progress.h"
#include "sheet/export_options.h"
#include "sheet/layout.h"
#include "sheet/needs.h"
#include "surface/pictures.h"

namespace devseg::exporting {

struct PatternFile {
    std::string bytes;
    std::vector<std::string> page_bytes; // of .png, one file for each page, instead of `bytes`
    Index pieces = 0;
    Index seams = 0;
    Index unnumbered_seams = 0; // for lack of room
    Index unnamed_pieces = 0;
    Index untabbed_seams = 0;
    Index sheets = 0;
    sheet::Needs needs;
    assembly::Assembly assembly;
    std::vector<pattern::Seam> seam_list;
    std::vector<pattern::ClothStrain> cloth; // of each piece, where there is a material
    std::vector<sheet::FabricStrip> fabrics; // of a marker
    std::vector<Index> piece_fabric;         // of each piece; 0 where the model is of one material
    Index pages = 0;                         // of a PDF or of .png; 0 for other formats
    std::vector<std::string> notes;          // for the user, one sentence each
};

/// The file options.output_file in the format of its extension; the caller writes it.
/// `face_material`: a number for each face (#F), or empty. `look` is what the surface shows, where
/// options.texture asks for it. Throws
/// InvalidParameter for options outside of their range, InvalidMesh and Cancelled.
PatternFile make_pattern_file(const Mesh& mesh, const CornerUv& uv,
                              const std::vector<Index>& face_material, const surface::Look& look,
                              const sheet::ExportOptions& options, Progress& progress);

/// The file of each page of a .png: `path` itself where there is one page, else with _1, _2, …
/// in front of its extension.
std::string page_file(const std::string& path, std::size_t page, std::size_t pages);

} // namespace devseg::exporting
