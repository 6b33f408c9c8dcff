#include "host/filter_host.h"

#include <optional>
#include <utility>

#include "host/host_errors.h"
#include "host/layout_uv.h"
#include "host/observer.h"
#include "host/rich_parameters.h"
#include "host/split_faces.h"
#include "host/textures.h"

namespace devseg::host {

namespace {

// Numbers as hosts print them; lists would fill the log.
std::string to_text(const declare::ResultValue& value) {
    if (std::holds_alternative<std::vector<double>>(value))
        return "(one value for each chart)";
    if (const auto* truth = std::get_if<bool>(&value))
        return *truth ? "true" : "false";
    if (const auto* count = std::get_if<int>(&value))
        return std::to_string(*count);
    return QString::number(std::get<double>(value)).toStdString();
}

// Hosts before 2021 ask for the mesh itself instead of its number.
template <class Document>
auto remove(Document& document, MeshModel& mesh) -> decltype(document.delMesh(&mesh)) {
    return document.delMesh(&mesh);
}
template <class Document>
auto remove(Document& document, MeshModel& mesh)
    -> decltype(document.delMesh(std::declval<unsigned&>())) {
    return document.delMesh(static_cast<unsigned>(mesh.id()));
}

// A layer that goes away again, with all that it holds, unless it is kept.
class NewLayer {
public:
    NewLayer(MeshDocument& document, const declare::LayerMesh& layer)
        : document_(document), before_(document.mm()->id()),
          mesh_(document.addNewMesh("", to_qstring(layer.name))) {
        try {
            fill_layer(*mesh_, layer);
        } catch (...) { // memory may run out
            take_back();
            throw;
        }
    }
    ~NewLayer() {
        if (mesh_ != nullptr)
            take_back();
    }
    NewLayer(const NewLayer&) = delete;
    NewLayer& operator=(const NewLayer&) = delete;
    void keep() { mesh_ = nullptr; }

private:
    void take_back() {
        remove(document_, *mesh_);
        document_.setCurrentMesh(before_);
    }

    MeshDocument& document_;
    int before_; // the current mesh
    MeshModel* mesh_;
};

} // namespace

HostRun run_in_host(const declare::FilterDeclaration& filter, MeshDocument& document,
                    const RichParameterList& parameters, vcg::CallBackPos* callback) {
    MeshModel* model = document.mm();
    if (model == nullptr)
        throw HostError("expected a mesh, found none; load one first");
    Progress progress(progress_callback(callback));
    return with_host_errors(*model, [&] {
        declare::HostMesh host = read_host_mesh(*model);
        if (filter.needs_uv)
            host.wedge_uv = read_layout_uv(*model);
        if (filter.needs_texture)
            read_textures(*model, host);
        const declare::ParameterValues values = parameter_values(filter, parameters);
        if (declare::wants_surface(filter, values))
            read_surface(*model, host);
        declare::HostResult result = declare::run_filter(filter, std::move(host), values, progress);
        HostRun run;
        std::optional<NewLayer> layer;
        if (result.layer)
            layer.emplace(document, *result.layer);
        if (result.refinement)
            split_faces(*model, *result.refinement);
        if (!result.wedge_uv.empty())
            keep_old_uv(*model);
        if (!result.face_color.empty())
            keep_old_colors(*model);
        run.changed = write_host_result(*model, result);
        if (result.texture) {
            replace_textures(*model, *result.texture);
            run.changed |= MeshModel::MM_WEDGTEXCOORD;
        }
        if (result.refinement)
            run.changed |= MeshModel::MM_GEOMETRY_AND_TOPOLOGY_CHANGE;
        if (layer)
            layer->keep();
        tell(result.notes);
        run.log = std::move(result.notes);
        for (const auto& [name, value] : result.values)
            run.log.push_back(name + ": " + to_text(value));
        run.values = std::move(result.values);
        return run;
    });
}

int written_elements(const declare::FilterDeclaration& filter) {
    int mask = MeshModel::MM_NONE;
    if (filter.writes & declare::writes_charts)
        mask |= MeshModel::MM_FACEFLAG | MeshModel::MM_FACEFLAGSELECT;
    if (filter.writes & declare::writes_quality)
        mask |= MeshModel::MM_FACEQUALITY;
    if (filter.writes & declare::writes_color)
        mask |= MeshModel::MM_FACECOLOR;
    if (filter.writes & (declare::writes_uv | declare::writes_texture))
        mask |= MeshModel::MM_WEDGTEXCOORD;
    if (filter.writes & declare::writes_points)
        mask |= MeshModel::MM_VERTCOORD | MeshModel::MM_VERTNORMAL | MeshModel::MM_FACENORMAL;
    if (filter.writes & declare::writes_mesh)
        mask |= MeshModel::MM_GEOMETRY_AND_TOPOLOGY_CHANGE;
    return mask;
}

} // namespace devseg::host
