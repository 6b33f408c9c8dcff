// References
//   Autodesk: AutoCAD 2000 DXF reference. 1999.
#include "writers/dxf_writer.h"

#include <algorithm>
#include <cmath>

#include "writers/dxf_text.h"
#include "writers/text.h"

namespace devseg::writers {

namespace {

void write_line_type(DxfText& file, const std::string& name, const std::string& look,
                     const std::vector<double>& strokes) {
    file.group(0, "LTYPE");
    file.group(2, name);
    file.group(70, "64");
    file.group(3, look);
    file.group(72, "65");
    file.count(73, static_cast<int>(strokes.size()));
    double length = 0.0;
    for (const double stroke : strokes)
        length += std::abs(stroke);
    file.number(40, length);
    for (const double stroke : strokes)
        file.number(49, stroke);
}

void write_tables(DxfText& file, const std::vector<const DrawingLayer*>& layers) {
    file.begin_section("TABLES");
    file.group(0, "TABLE");
    file.group(2, "LTYPE");
    file.group(70, "2");
    write_line_type(file, "CONTINUOUS", "Solid line", {});
    write_line_type(file, "DASHED", "__ __ __ __", {3.0, -1.5});
    file.group(0, "ENDTAB");
    file.group(0, "TABLE");
    file.group(2, "LAYER");
    file.count(70, static_cast<int>(layers.size()));
    for (const DrawingLayer* layer : layers) {
        file.group(0, "LAYER");
        file.group(2, dxf_layer_name(*layer));
        file.group(70, "0");
        file.count(62, dxf_colour(layer->colour));
        file.group(6, layer->dash.empty() ? "CONTINUOUS" : "DASHED");
    }
    file.group(0, "ENDTAB");
    file.end_section();
}

constexpr int degree = 3;
constexpr int millimetres = 4; // of $INSUNITS

// Writes a file of release 2000, whose objects all have handles and owners. Each outline with
// curves is one spline of degree 3: the Bézier curves one after the other, straight lines among
// them.
class Writer {
public:
    explicit Writer(int decimals) : file_(decimals) {}

    std::string write(const Drawing& drawing, const std::vector<const DrawingLayer*>& layers) {
        write_tables(layers);
        write_blocks();
        file_.begin_section("ENTITIES");
        for (const DrawingLayer* layer : layers) {
            const std::string name = dxf_layer_name(*layer);
            for (const DrawingPath& path : layer->paths)
                for (const DrawingPolyline& part : path.parts)
                    write_line(name, part);
            for (const DrawingText& text : layer->texts)
                write_text(name, text);
        }
        file_.end_section();
        write_objects();
        // The header tells the first free handle: it is written last.
        DxfText header(drawing.decimals);
        header.begin_section("HEADER");
        const auto variable = [&](const char* name) { header.group(9, name); };
        variable("$ACADVER");
        header.group(1, "AC1015");
        variable("$INSUNITS");
        header.count(70, millimetres);
        variable("$EXTMIN");
        header.point(Vec2::Zero());
        header.number(30, 0.0);
        variable("$EXTMAX");
        header.point(Vec2(drawing.width, drawing.height));
        header.number(30, 0.0);
        variable("$HANDSEED");
        header.group(5, hexadecimal(next_));
        header.end_section();
        return header.text_so_far() + file_.file();
    }

private:
    static std::string hexadecimal(int value) {
        std::string text;
        for (; value > 0; value /= 16)
            text.insert(text.begin(), "0123456789ABCDEF"[value % 16]);
        return text;
    }

    // Handle and owner, and the classes of the object.
    int begin(const char* type, const std::string& owner, int handle_code = 5) {
        file_.group(0, type);
        file_.group(handle_code, hexadecimal(next_));
        if (!owner.empty())
            file_.group(330, owner);
        return next_++;
    }
    void classes(std::initializer_list<const char*> names) {
        for (const char* name : names)
            file_.group(100, name);
    }

    std::string begin_table(const char* name, int count) {
        file_.group(0, "TABLE");
        file_.group(2, name);
        file_.group(5, hexadecimal(next_));
        file_.group(330, "0");
        file_.group(100, "AcDbSymbolTable");
        file_.count(70, count);
        return hexadecimal(next_++);
    }
    int record(const char* type, const std::string& table, const char* kind,
               const std::string& name, int handle_code = 5) {
        const int handle = begin(type, table, handle_code);
        classes({"AcDbSymbolTableRecord", kind});
        file_.group(2, name);
        return handle;
    }
    void end_table() { file_.group(0, "ENDTAB"); }

    void write_line_type(const std::string& table, const char* name,
                         const std::vector<double>& strokes) {
        record("LTYPE", table, "AcDbLinetypeTableRecord", name);
        file_.count(70, 0);
        file_.group(3, "");
        file_.count(72, 65);
        file_.count(73, static_cast<int>(strokes.size()));
        double length = 0.0;
        for (const double stroke : strokes)
            length += std::abs(stroke);
        file_.number(40, length);
        for (const double stroke : strokes) {
            file_.number(49, stroke);
            file_.count(74, 0);
        }
    }

    void write_layer(const std::string& table, const std::string& name, int colour,
                     const char* line_type) {
        record("LAYER", table, "AcDbLayerTableRecord", name);
        file_.count(70, 0);
        file_.count(62, colour);
        file_.group(6, line_type);
    }

    void write_tables(const std::vector<const DrawingLayer*>& layers) {
        file_.begin_section("TABLES");
        begin_table("VPORT", 0);
        end_table();
        std::string table = begin_table("LTYPE", 4);
        write_line_type(table, "BYBLOCK", {});
        write_line_type(table, "BYLAYER", {});
        write_line_type(table, "CONTINUOUS", {});
        write_line_type(table, "DASHED", {3.0, -1.5});
        end_table();
        table = begin_table("LAYER", static_cast<int>(layers.size()) + 1);
        write_layer(table, "0", 7, "CONTINUOUS");
        for (const DrawingLayer* layer : layers)
            write_layer(table, dxf_layer_name(*layer), dxf_colour(layer->colour),
                        layer->dash.empty() ? "CONTINUOUS" : "DASHED");
        end_table();
        table = begin_table("STYLE", 1);
        record("STYLE", table, "AcDbTextStyleTableRecord", "STANDARD");
        file_.count(70, 0);
        file_.number(40, 0.0);
        file_.number(41, 1.0);
        file_.number(50, 0.0);
        file_.count(71, 0);
        file_.number(42, 1.0);
        file_.group(3, "txt");
        file_.group(4, "");
        end_table();
        for (const char* empty : {"VIEW", "UCS"}) {
            begin_table(empty, 0);
            end_table();
        }
        table = begin_table("APPID", 1);
        record("APPID", table, "AcDbRegAppTableRecord", "ACAD");
        file_.count(70, 0);
        end_table();
        table = begin_table("DIMSTYLE", 1);
        file_.group(100, "AcDbDimStyleTable");
        record("DIMSTYLE", table, "AcDbDimStyleTableRecord", "STANDARD", 105);
        file_.count(70, 0);
        end_table();
        table = begin_table("BLOCK_RECORD", 2);
        for (const bool model : {true, false})
            (model ? model_ : paper_) =
                hexadecimal(record("BLOCK_RECORD", table, "AcDbBlockTableRecord",
                                   model ? "*MODEL_SPACE" : "*PAPER_SPACE"));
        end_table();
        file_.end_section();
    }

    void write_blocks() {
        file_.begin_section("BLOCKS");
        for (const bool model : {true, false}) {
            const std::string& owner = model ? model_ : paper_;
            const char* name = model ? "*MODEL_SPACE" : "*PAPER_SPACE";
            begin("BLOCK", owner);
            classes({"AcDbEntity"});
            file_.group(8, "0");
            classes({"AcDbBlockBegin"});
            file_.group(2, name);
            file_.count(70, 0);
            file_.point(Vec2::Zero());
            file_.number(30, 0.0);
            file_.group(3, name);
            file_.group(1, "");
            begin("ENDBLK", owner);
            classes({"AcDbEntity"});
            file_.group(8, "0");
            classes({"AcDbBlockEnd"});
        }
        file_.end_section();
    }

    void write_objects() {
        file_.begin_section("OBJECTS");
        const int root = begin("DICTIONARY", "0");
        classes({"AcDbDictionary"});
        file_.count(281, 1);
        file_.group(3, "ACAD_GROUP");
        file_.group(350, hexadecimal(root + 1));
        begin("DICTIONARY", hexadecimal(root));
        classes({"AcDbDictionary"});
        file_.count(281, 1);
        file_.end_section();
    }

    void begin_entity(const char* type, const std::string& layer, const char* kind) {
        begin(type, model_);
        classes({"AcDbEntity"});
        file_.group(8, layer);
        classes({kind});
    }

    void write_line(const std::string& layer, const DrawingPolyline& line) {
        if (!line.curves.empty()) {
            write_spline(layer, line);
            return;
        }
        DxfText vertices = file_.empty_copy();
        int count = 0;
        for (const std::string& vertex : point_texts(line, [&](const Vec2& p) {
                 DxfText one = file_.empty_copy();
                 one.point(p);
                 return one.text_so_far();
             })) {
            vertices.append(vertex);
            ++count;
        }
        if (count < 2)
            return;
        begin_entity("LWPOLYLINE", layer, "AcDbPolyline");
        file_.count(90, count);
        file_.count(70, line.closed ? 1 : 0);
        file_.append(vertices.text_so_far());
    }

    // The joints are knots of multiplicity 3: there the curve passes through its control points.
    void write_spline(const std::string& layer, const DrawingPolyline& line) {
        const int curves = static_cast<int>(line.curves.size());
        begin_entity("SPLINE", layer, "AcDbSpline");
        file_.count(70, (line.closed ? 1 : 0) + 8); // closed, planar
        file_.count(71, degree);
        file_.count(72, degree * (curves + 1) + 2);
        file_.count(73, degree * curves + 1);
        file_.count(74, 0);
        file_.number(42, 1e-7);
        file_.number(43, 1e-7);
        for (int knot = 0; knot <= curves; ++knot)
            for (int i = knot == 0 || knot == curves ? -1 : 0; i < degree; ++i)
                file_.number(40, knot);
        const auto control = [&](const Vec2& p) {
            file_.point(p);
            file_.number(30, 0.0);
        };
        control(line.curves.front().control[0]);
        for (const DrawingCurve& curve : line.curves)
            for (const int k : {1, 2, 3})
                control(curve.control[static_cast<std::size_t>(k)]);
    }

    void write_text(const std::string& layer, const DrawingText& text) {
        begin_entity("TEXT", layer, "AcDbText");
        file_.text_content(text);
        classes({"AcDbText"});
    }

    DxfText file_;
    int next_ = 1; // handle
    std::string model_;
    std::string paper_;
};

} // namespace

std::string dxf_bytes(const Drawing& drawing) {
    std::vector<const DrawingLayer*> layers;
    for (const DrawingLayer& layer : drawing.layers)
        if (!layer.paths.empty() || !layer.texts.empty())
            layers.push_back(&layer);
    const auto has_curves = [](const DrawingLayer* layer) {
        return std::any_of(layer->paths.begin(), layer->paths.end(), [](const DrawingPath& path) {
            return std::any_of(path.parts.begin(), path.parts.end(),
                               [](const DrawingPolyline& part) { return !part.curves.empty(); });
        });
    };
    if (std::any_of(layers.begin(), layers.end(), has_curves))
        return Writer(drawing.decimals).write(drawing, layers);
    DxfText file(drawing.decimals);
    file.begin_section("HEADER");
    file.group(9, "$ACADVER");
    file.group(1, "AC1009");
    file.group(9, "$EXTMIN");
    file.point(Vec2::Zero());
    file.group(9, "$EXTMAX");
    file.point(Vec2(drawing.width, drawing.height));
    file.end_section();
    write_tables(file, layers);
    file.begin_section("ENTITIES");
    for (const DrawingLayer* layer : layers) {
        for (const DrawingPath& path : layer->paths)
            for (const DrawingPolyline& part : path.parts)
                file.polyline(dxf_layer_name(*layer), part);
        for (const DrawingText& text : layer->texts)
            file.text(dxf_layer_name(*layer), text);
    }
    file.end_section();
    return file.file();
}

} // namespace devseg::writers
