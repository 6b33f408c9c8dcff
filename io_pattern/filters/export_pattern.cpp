#include "filters/export_pattern.h"

#include <algorithm>
#include <cstdlib>
#include <ctime>

#include "devseg/base/errors.h"
#include "page/page.h"
#include "sheet/apparel_dxf.h"
#include "sheet/cover.h"
#include "sheet/drawing_plan.h"
#include "sheet/fabrics.h"
#include "sheet/sheet_drawing.h"
#include "sheet/sizes.h"
#include "surface/registration.h"
#include "writers/canvas.h"
#include "writers/dxf_writer.h"
#include "writers/font.h"
#include "writers/pdf_writer.h"
#include "writers/svg_writer.h"

namespace devseg::exporting {

namespace {

enum class Format { svg, pdf, dxf, html, png };

std::size_t name_start(const std::string& path) {
    const std::size_t slash = path.find_last_of("/\\");
    return slash == std::string::npos ? 0 : slash + 1;
}

Format format_of(const std::string& path) {
    if (path.empty())
        throw InvalidParameter("output_file: expected the name of a file, found none");
    const std::size_t dot = path.find_last_of('.');
    std::string extension =
        dot == std::string::npos || dot < name_start(path) ? "" : path.substr(dot);
    for (char& c : extension)
        c = c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
    if (extension == ".svg")
        return Format::svg;
    if (extension == ".pdf")
        return Format::pdf;
    if (extension == ".dxf")
        return Format::dxf;
    if (extension == ".html")
        return Format::html;
    if (extension == ".png")
        return Format::png;
    throw InvalidParameter("output_file: expected a file that ends in .svg, .pdf, .dxf, .html or "
                           ".png, found '" +
                           path + "'");
}

std::string title_of(const std::string& path) {
    const std::size_t start = name_start(path);
    return path.substr(start, path.find_last_of('.') - start);
}

// Builds that must be the same on every day say which day it is.
std::string today() {
    std::time_t now = std::time(nullptr);
    if (const char* epoch = std::getenv("SOURCE_DATE_EPOCH"))
        now = static_cast<std::time_t>(std::atoll(epoch));
    std::tm parts{};
    gmtime_r(&now, &parts);
    char text[32];
    std::strftime(text, sizeof text, "%d-%m-%Y", &parts);
    return text;
}

bool is_apparel(const sheet::ExportOptions& options) {
    return options.dxf_kind == sheet::DxfKind::apparel ||
           (!options.is_marker() && options.dxf_kind == sheet::DxfKind::automatic &&
            options.preset == sheet::PatternPreset::sewing);
}

// What a pattern is drawn from.
struct Source {
    const pattern::Pattern& pattern;
    const sheet::PatternLayout& layout;
    const sheet::ExportOptions& options;
    const surface::Look& look;
};

// The sheets with what is printed on the pieces. `marks` as the options want them, but on pages of
// their own.
writers::Drawing draw(const Source& source, const sheet::ExportOptions& options, bool marks,
                      Progress& progress, std::vector<std::string>& notes) {
    writers::Drawing drawing = sheet::draw_sheets(source.layout, options);
    if (options.texture != sheet::SurfacePrint::none)
        for (std::string& note : surface::add_pictures(source.pattern, source.layout, options,
                                                       source.look, progress, drawing))
            notes.push_back(std::move(note));
    if (options.registration_marks && marks)
        drawing.layers.push_back(surface::registration_marks(
            source.layout, drawing,
            sheet::plan_drawing(source.layout, options.scale_check).sheets.front()));
    return drawing;
}

writers::Document make_document(const Source& source, Progress& progress,
                                std::vector<std::string>& notes) {
    const auto& [pattern, layout, options, look] = source;
    writers::Document document;
    document.title = title_of(options.output_file);
    // Pages of a PDF have marks of their own.
    sheet::ExportOptions drawn = options;
    drawn.frame = drawn.scale_check = !layout.page;
    document.drawing = draw(source, drawn, !layout.page, progress, notes);
    const std::vector<sheet::PrintedPage> printed = sheet::printed_pages(layout, document.drawing);
    progress.check();
    if (options.cover)
        document.pages = sheet::cover_pages(pattern, layout, printed, options, document.title);
    progress.check();
    if (options.cover && layout.page && printed.size() > 1)
        sheet::add_overview(layout, document.drawing, printed, document.title, document.pages);
    for (writers::DocumentPage& page :
         sheet::page_sheets(layout, document.drawing, printed, document.title)) {
        if (options.registration_marks && layout.page)
            page.marks.push_back(surface::registration_marks({{Vec2::Zero(), layout.page->size}},
                                                             layout.page->margin));
        document.pages.push_back(std::move(page));
    }
    return document;
}

// Pages with pieces on them.
Index printed_count(const sheet::PatternLayout& layout) {
    writers::Drawing places;
    places.sheets.resize(layout.sheets.size());
    return static_cast<Index>(sheet::printed_pages(layout, places).size());
}

// A marker is one large sheet to cut, without pages about the model.
sheet::ExportOptions format_options(sheet::ExportOptions options, Format format) {
    const std::vector<double> sizes = sheet::read_sizes(options.sizes);
    if (!sizes.empty()) {
        if (options.is_marker() || format == Format::html ||
            (format == Format::dxf && is_apparel(options)))
            throw InvalidParameter("sizes: expected one file with all sizes in .svg, .pdf or .dxf "
                                   "for cutters, found a marker, a page or apparel DXF; write a "
                                   "file for each size (height_mm)");
        options.height_mm = sizes.back();
    }
    if (format == Format::png)
        options.cover = false;
    if (!options.is_marker())
        return options;
    if (format == Format::html)
        throw InvalidParameter("fabric_width_mm: expected a marker in .svg, .pdf or .dxf, found "
                               ".html; leave fabric_width_mm out");
    if (options.dxf_kind == sheet::DxfKind::apparel && format == Format::dxf)
        throw InvalidParameter("dxf_kind: expected Cutter for a marker, found Apparel, which has "
                               "pieces and no layout");
    options.cover = false;
    options.edge_numbers = options.edge_numbers && !options.fold; // halves have half of them
    return options;
}

void check_zips(const sheet::AllowanceWidths& widths, Index seams) {
    for (const Index seam : widths.zip_seams)
        if (seam >= seams)
            throw InvalidParameter("zip_seams: expected numbers of seams up to " +
                                   std::to_string(seams) + ", found " + std::to_string(seam + 1));
}

// The bytes of the file, or of each of its pages.
void write(const Source& source, Format format, Progress& progress, PatternFile& file) {
    const auto& [pattern, layout, options, look] = source;
    const std::string title = title_of(options.output_file);
    auto drawing = progress.part(0.5);
    if (format == Format::html) {
        file.bytes = page::page_bytes(pattern, layout, options, title, progress);
    } else if (format == Format::dxf && is_apparel(options)) {
        file.bytes = sheet::apparel_dxf_bytes(pattern, layout, options, {title, today()});
    } else if (format == Format::pdf || format == Format::png) {
        const writers::Document document = make_document(source, drawing, file.notes);
        file.pages = static_cast<Index>(document.pages.size());
        if (format == Format::pdf)
            file.bytes = writers::pdf_bytes(document);
        else
            file.page_bytes = writers::png_pages(document);
    } else {
        sheet::ExportOptions drawn = options;
        if (format == Format::dxf) // holds no pictures
            drawn.texture = sheet::SurfacePrint::none;
        writers::Drawing sheets = draw(source, drawn, true, drawing, file.notes);
        if (format == Format::svg && options.text == sheet::TextKind::paths)
            sheets = writers::with_outlined_texts(std::move(sheets));
        file.bytes =
            format == Format::svg ? writers::svg_bytes(sheets) : writers::dxf_bytes(sheets);
    }
    const int missing = writers::missing_glyphs(title);
    if (missing > 0 && format == Format::pdf)
        file.notes.push_back(std::to_string(missing) +
                             " characters of the file's name are in no font that PDF files get: "
                             "they are drawn as boxes");
}

// What the file holds, as numbers and notes.
void describe(const Source& source, PatternFile& file) {
    const auto& [pattern, layout, options, look] = source;
    file.pieces = static_cast<Index>(pattern.pieces.size());
    file.seams = static_cast<Index>(pattern.seams.size());
    file.unnumbered_seams = static_cast<Index>(layout.left_out.seams.size());
    file.unnamed_pieces = static_cast<Index>(layout.left_out.pieces.size());
    file.untabbed_seams = layout.seams_without_tab;
    file.sheets = static_cast<Index>(layout.sheets.size());
    file.needs = sheet::find_needs(pattern, layout, options, printed_count(layout));
    file.assembly = layout.assembly;
    file.seam_list = pattern.seams;
    for (const pattern::PatternPiece& piece : pattern.pieces) {
        file.piece_fabric.push_back(piece.fabric);
        if (pattern.material)
            file.cloth.push_back(piece.cloth);
    }
    file.fabrics = layout.fabrics;
    for (std::string& note : sheet::layout_notes(pattern, layout))
        file.notes.push_back(std::move(note));
}

} // namespace

PatternFile make_pattern_file(const Mesh& mesh, const CornerUv& uv,
                              const std::vector<Index>& face_material, const surface::Look& look,
                              const sheet::ExportOptions& given, Progress& progress) {
    const Format format = format_of(given.output_file);
    const sheet::ExportOptions options =
        sheet::limited_to_page(format_options(sheet::resolved(given), format));
    sheet::page_format(options); // says what is wrong with it before the work begins
    const bool has_pictures = format == Format::pdf && options.cover; // which take long
    auto making = progress.part(has_pictures ? 0.2 : 0.5);
    pattern::Pattern pattern = pattern::make_pattern(mesh, uv, options, making);
    check_zips(options.allowance(), static_cast<Index>(pattern.seams.size()));
    sheet::set_fabrics(face_material, options.material_names, pattern);
    auto laying = progress.part(has_pictures ? 0.15 : 0.3);
    sheet::PatternLayout layout = sheet::lay_out_pattern(pattern, options, laying);
    auto grading = progress.part("other sizes", has_pictures ? 0.05 : 0.1);
    if (!options.sizes.empty())
        sheet::add_sizes(mesh, uv, pattern, options, layout, grading);
    auto writing = progress.part("writing", progress.left());
    PatternFile file;
    file.notes = pattern.notes;
    const Source source{pattern, layout, options, look};
    write(source, format, writing, file);
    writing.update(0.5);
    describe(source, file);
    return file;
}

std::string page_file(const std::string& path, std::size_t page, std::size_t pages) {
    if (pages == 1)
        return path;
    const std::size_t dot = path.find_last_of('.');
    return path.substr(0, dot) + '_' + std::to_string(page + 1) + path.substr(dot);
}

} // namespace devseg::exporting
