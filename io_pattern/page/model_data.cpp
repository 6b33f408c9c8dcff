#include "page/model_data.h"

#include <algorithm>
#include <cmath>
#include <map>

#include <QJsonArray>
#include <QJsonDocument>
#include <QJsonObject>

#include "devseg/pattern/inside.h"
#include "sheet/cloth_texts.h"

namespace devseg::page {

namespace {

constexpr double steps = 65535.0;      // of a coordinate
constexpr double strain_steps = 127.0; // of the range that colours show, to each side
constexpr double strain_ranges[] = {0.05, 0.1, 0.2, 0.5, 1.0};
constexpr double strain_share = 0.9; // of the area that the range holds, if one does

QString text(const std::string& utf8) {
    return QString::fromStdString(utf8);
}

// Hundredths are enough for a screen, and short in the file.
double rounded(double value) {
    return std::round(100.0 * value) / 100.0;
}

template <class Number>
QString packed(const std::vector<Number>& numbers) {
    QByteArray bytes;
    bytes.reserve(static_cast<int>(numbers.size() * sizeof(Number)));
    for (const Number number : numbers)
        for (std::size_t k = 0; k < sizeof(Number); ++k)
            bytes.append(static_cast<char>(static_cast<std::uint32_t>(number) >> (8 * k) & 0xffU));
    return QString::fromLatin1(bytes.toBase64());
}

QJsonArray flat(const std::vector<Vec2>& points) {
    QJsonArray array;
    for (const Vec2& p : points) {
        array.append(rounded(p.x()));
        array.append(rounded(p.y()));
    }
    return array;
}

template <class Numbers>
QJsonArray array_of(const Numbers& numbers) {
    QJsonArray array;
    for (const auto number : numbers)
        array.append(static_cast<int>(number));
    return array;
}

class Model {
public:
    Model(const pattern::Pattern& pattern, const sheet::PatternLayout& layout,
          const sheet::ExportOptions& options, const writers::Drawing& drawing)
        : pattern_(pattern), layout_(layout), options_(options), drawing_(drawing),
          mm_(pattern.mesh.unit_length * pattern.mm_per_unit) {
        for (const Vec3& p : pattern.mesh.points)
            box_.extend(mm_ * p);
        step_ = std::max(box_.sizes().maxCoeff(), 1e-9) / steps;
        find_strain();
    }

    // The strain that the end of the colours stands for.
    double strain_range() const { return strain_range_; }

    QJsonObject box() const {
        return {{"low", QJsonArray{box_.min().x(), box_.min().y(), box_.min().z()}},
                {"size", steps * step_}};
    }

    QJsonArray pieces(const Progress& progress) const {
        const std::vector<std::vector<Index>> faces = faces_of_pieces();
        const std::vector<declare::Color> colors = sheet::piece_colors(pattern_);
        QJsonArray result;
        for (std::size_t i = 0; i < pattern_.pieces.size(); ++i) {
            progress.check();
            const pattern::PatternPiece& piece = pattern_.pieces[i];
            const declare::Color& color = colors[i];
            QJsonObject data = geometry(faces[i]);
            data["name"] = text(piece.name);
            data["section"] = text(assembly::section_name(layout_.assembly.section[i]));
            data["color"] = array_of(color);
            data["length"] = rounded(piece.long_side);
            data["width"] = rounded(piece.short_side);
            data["label"] = flat({on_sheet(layout_.pieces[i], piece.label_position)});
            data["area"] = rounded(1e-2 * piece.area);
            data["extension"] = rounded(100.0 * piece.strain.extension);
            data["compression"] = rounded(100.0 * piece.strain.compression);
            if (pattern_.material)
                data["cloth"] = text(sheet::cloth_text(pattern_, piece));
            result.append(data);
        }
        return result;
    }

    QJsonArray seams() const {
        QJsonArray result;
        for (std::size_t s = 0; s < pattern_.seams.size(); ++s) {
            const pattern::Seam& seam = pattern_.seams[s];
            QJsonArray sides;
            for (const pattern::SeamSide& side : seam.sides)
                sides.append(QJsonObject{{"piece", side.piece},
                                         {"mm", rounded(side.length)},
                                         {"sheet", flat(on_sheet(side))},
                                         {"model", on_model(side)}});
            result.append(QJsonObject{{"label", text(seam.label)},
                                      {"dart", seam.is_dart},
                                      {"step", layout_.assembly.seam_step[s]},
                                      {"sides", sides}});
        }
        return result;
    }

    QJsonArray pages() const {
        QJsonArray result;
        for (const writers::DrawingSheet& page : drawing_.pages)
            result.append(QJsonArray{rounded(page.low.x()),
                                     rounded(drawing_.height - page.low.y() - page.size.y()),
                                     rounded(page.size.x()), rounded(page.size.y())});
        return result;
    }

    QJsonArray steps_of_assembly() const {
        QJsonArray result;
        for (std::size_t k = 0; k < layout_.assembly.steps.size(); ++k) {
            const assembly::AssemblyStep& step = layout_.assembly.steps[k];
            result.append(
                QJsonObject{{"text", text(sheet::step_text(pattern_, layout_, options_, k))},
                            {"seams", array_of(step.seams)},
                            {"pieces", array_of(step.pieces)}});
        }
        return result;
    }

private:
    // Of each face the larger one of its strains, below 0 where it is compressed.
    void find_strain() {
        for (const pattern::FaceStrain& s :
             pattern::measure_strain(pattern_.mesh, pattern_.corner_place, 1.0 / mm_))
            strain_.push_back(s.extension > s.compression ? s.extension : -s.compression);
        for (const double range : strain_ranges) {
            strain_range_ = range;
            double inside = 0.0;
            for (const Face f : pattern_.mesh.all_faces())
                inside += std::abs(strain_[f]) <= range ? pattern_.mesh.face_areas[f] : 0.0;
            if (inside >= strain_share * pattern_.mesh.total_area)
                return;
        }
    }

    std::vector<std::vector<Index>> faces_of_pieces() const {
        std::vector<std::vector<Index>> faces(pattern_.pieces.size());
        for (std::size_t f = 0; f < pattern_.face_piece.size(); ++f)
            if (pattern_.face_piece[f] >= 0)
                faces[at(pattern_.face_piece[f])].push_back(static_cast<Index>(f));
        return faces;
    }

    void quantise(const Vec3& point, std::vector<std::uint16_t>& numbers) const {
        const Vec3 p = (mm_ * point - box_.min()) / step_;
        for (int k = 0; k < 3; ++k)
            numbers.push_back(static_cast<std::uint16_t>(std::lround(p[k])));
    }

    // Vertices of the piece alone, its faces, and the pairs of vertices along its border.
    QJsonObject geometry(const std::vector<Index>& faces) const {
        const Mesh& mesh = pattern_.mesh;
        std::map<Index, std::uint32_t> number;
        std::vector<std::uint16_t> points;
        std::vector<double> sum;
        std::vector<int> count;
        std::vector<std::uint32_t> corners;
        std::vector<std::uint32_t> border;
        for (const Index f : faces) {
            const double value = strain_[at(f)];
            for (const Index v : mesh.faces[at(f)]) {
                const auto [known, is_new] =
                    number.emplace(v, static_cast<std::uint32_t>(number.size()));
                if (is_new) {
                    quantise(mesh.points[at(v)], points);
                    sum.push_back(0.0);
                    count.push_back(0);
                }
                corners.push_back(known->second);
                sum[known->second] += value;
                ++count[known->second];
            }
        }
        for (const Index f : faces)
            for (const HalfEdge h : half_edges_of(Face(f)))
                if (pattern_.seam[h] != 0 || mesh.twin[h] < 0) {
                    border.push_back(number.at(mesh.origin(h)));
                    border.push_back(number.at(mesh.target(h)));
                }
        std::vector<std::uint8_t> strains;
        for (std::size_t i = 0; i < sum.size(); ++i)
            strains.push_back(static_cast<std::uint8_t>(static_cast<int>(
                128.0 + std::clamp(sum[i] / count[i] / strain_range_, -1.0, 1.0) * strain_steps)));
        const bool is_small = number.size() <= 65535;
        QJsonObject data{
            {"bits", is_small ? 16 : 32}, {"points", packed(points)}, {"strain", packed(strains)}};
        const auto add = [&](const char* name, const std::vector<std::uint32_t>& indices) {
            data[name] = is_small
                             ? packed(std::vector<std::uint16_t>(indices.begin(), indices.end()))
                             : packed(indices);
        };
        add("faces", corners);
        add("border", border);
        return data;
    }

    // Points of the outline along a side, from the seam's start.
    template <class Point>
    auto along(const pattern::SeamSide& side, Point point) const {
        const pattern::PiecePath& path = pattern_.pieces[at(side.piece)].path(side.path);
        std::vector<decltype(point(path, std::size_t{0}))> points;
        for (Index i = 0; i <= side.count; ++i)
            points.push_back(point(path, at(side.first + i) % path.points.size()));
        if (side.reversed)
            std::reverse(points.begin(), points.end());
        return points;
    }

    // Where a point of a piece lies in the drawing, y down.
    Vec2 on_sheet(const sheet::SheetPiece& piece, const Vec2& point) const {
        const Vec2 p = piece.frame(point) + drawing_.sheet_low(piece.sheet);
        return {p.x(), drawing_.height - p.y()};
    }

    std::vector<Vec2> on_sheet(const pattern::SeamSide& side) const {
        return along(side, [&](const pattern::PiecePath& path, std::size_t i) {
            return on_sheet(layout_.pieces[at(side.piece)], path.points[i]);
        });
    }

    QString on_model(const pattern::SeamSide& side) const {
        std::vector<std::uint16_t> numbers;
        for (const Vec3& p : along(side, [&](const pattern::PiecePath&path, std::size_t i) {
                 return pattern_.mesh.points[pattern_.mesh.origin(path.half_edge[i])];
             }))
            quantise(p, numbers);
        return packed(numbers);
    }

    const pattern::Pattern& pattern_;
    const sheet::PatternLayout& layout_;
    const sheet::ExportOptions& options_;
    const writers::Drawing& drawing_;
    double mm_;
    Eigen::AlignedBox3d box_;    // mm
    double step_ = 1.0;          // mm
    std::vector<double> strain_; // #F
    double strain_range_ = 1.0;
};

} // namespace

QByteArray model_data(const pattern::Pattern& pattern, const sheet::PatternLayout& layout,
                      const sheet::ExportOptions& options, const writers::Drawing& drawing,
                      const std::string& title, const Progress& progress) {
    const Model model(pattern, layout, options, drawing);
    QJsonArray needs;
    const auto pages = static_cast<Index>(drawing.pages.size());
    for (const auto& [name, value] :
         sheet::needs_texts(pattern, sheet::find_needs(pattern, layout, options, pages), options))
        needs.append(QJsonArray{text(name), text(value)});
    QJsonArray openings;
    for (const std::string& opening : sheet::opening_texts(pattern, layout))
        openings.append(text(opening));
    return QJsonDocument(QJsonObject{{"title", text(title)},
                                     {"allowance", options.seam_allowance_mm},
                                     {"size", QJsonArray{drawing.width, drawing.height}},
                                     {"box", model.box()},
                                     {"strain", model.strain_range()},
                                     {"pieces", model.pieces(progress)},
                                     {"seams", model.seams()},
                                     {"pages", model.pages()},
                                     {"steps", model.steps_of_assembly()},
                                     {"openings", openings},
                                     {"needs", needs}})
        .toJson(QJsonDocument::Compact);
}

} // namespace devseg::page
