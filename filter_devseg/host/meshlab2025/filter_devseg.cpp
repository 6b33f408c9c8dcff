#include "filter_devseg.h"

#include <charconv>
#include <cmath>

#include "devseg/errors.h"
#include "host/vcg_bridge.h"

namespace {

using devseg::FilterCategory;
using devseg::FilterDeclaration;
using devseg::Parameter;
using devseg::ParameterKind;

const FilterDeclaration& declaration(int filter) {
    return devseg::filter_table().at(static_cast<std::size_t>(filter));
}

QString text(const std::string& s) {
    return QString::fromUtf8(s.data(), static_cast<int>(s.size()));
}

// Hosts carry reals in 32 bit. The shortest decimal that rounds to the same float is what the user
// wrote: 0.2 and not 0.200000003.
double as_written(Scalarm value) {
    const float single = static_cast<float>(value);
    if (!std::isfinite(single))
        return static_cast<double>(value);
    char digits[32];
    const auto end = std::to_chars(digits, digits + sizeof digits, single).ptr;
    double result = 0.0;
    std::from_chars(digits, end, result);
    return result;
}

void add_parameter(RichParameterList& list, const Parameter& p) {
    const QString name = text(p.name);
    const QString label = text(p.label);
    const QString help = text(p.help);
    switch (p.kind) {
    case ParameterKind::boolean:
        list.addParam(RichBool(name, std::get<bool>(p.default_value), label, help));
        break;
    case ParameterKind::integer:
        list.addParam(RichInt(name, std::get<int>(p.default_value), label, help));
        break;
    case ParameterKind::real:
        list.addParam(
            RichFloat(name, static_cast<Scalarm>(std::get<double>(p.default_value)), label, help));
        break;
    case ParameterKind::choice: {
        QStringList choices;
        for (const std::string& choice : p.choices)
            choices.push_back(text(choice));
        list.addParam(RichEnum(name, std::get<int>(p.default_value), choices, label, help));
        break;
    }
    }
}

devseg::ParameterValue read_parameter(const RichParameterList& list, const Parameter& p) {
    const QString name = text(p.name);
    switch (p.kind) {
    case ParameterKind::boolean:
        return list.getBool(name);
    case ParameterKind::integer:
        return list.getInt(name);
    case ParameterKind::real:
        return as_written(list.getFloat(name));
    case ParameterKind::choice:
        return list.getEnum(name);
    }
    return p.default_value;
}

QVariant to_variant(const devseg::ResultValue& value) {
    if (const auto* values = std::get_if<std::vector<double>>(&value)) {
        Eigen::VectorXd vector(static_cast<Eigen::Index>(values->size()));
        for (std::size_t i = 0; i < values->size(); ++i)
            vector[static_cast<Eigen::Index>(i)] = (*values)[i];
        return QVariant::fromValue(vector);
    }
    if (const auto* truth = std::get_if<bool>(&value))
        return QVariant(*truth);
    if (const auto* count = std::get_if<int>(&value))
        return QVariant(*count);
    return QVariant(std::get<double>(value));
}

std::string to_text(const devseg::ResultValue& value) {
    const QVariant variant = to_variant(value);
    return variant.canConvert<Eigen::VectorXd>() ? "(one value for each chart)"
                                                 : variant.toString().toStdString();
}

} // namespace

DevsegFilterPlugin::DevsegFilterPlugin() {
    const int count = static_cast<int>(devseg::filter_table().size());
    for (int filter = 0; filter < count; ++filter) {
        typeList.push_back(filter);
        actionList.push_back(new QAction(filterName(filter), this));
    }
}

QString DevsegFilterPlugin::pluginName() const {
    return "FilterDevseg";
}

QString DevsegFilterPlugin::vendor() const {
    return "devseg";
}

QString DevsegFilterPlugin::filterName(ActionIDType filter) const {
    return text(declaration(filter).menu_name);
}

QString DevsegFilterPlugin::pythonFilterName(ActionIDType filter) const {
    return text(declaration(filter).python_name);
}

QString DevsegFilterPlugin::filterInfo(ActionIDType filter) const {
    return text(declaration(filter).help);
}

FilterPlugin::FilterClass DevsegFilterPlugin::getClass(const QAction* action) const {
    switch (declaration(ID(action)).category) {
    case FilterCategory::remeshing:
        return FilterPlugin::Remeshing;
    case FilterCategory::texture:
        return FilterPlugin::Texture;
    case FilterCategory::color:
        return FilterPlugin::FaceColoring;
    case FilterCategory::measure:
        return FilterPlugin::Measure;
    }
    return FilterPlugin::Remeshing;
}

FilterPlugin::FilterArity DevsegFilterPlugin::filterArity(const QAction*) const {
    return FilterPlugin::SINGLE_MESH;
}

int DevsegFilterPlugin::getPreConditions(const QAction*) const {
    return MeshModel::MM_NONE; // the input gate says more than a greyed-out menu entry
}

int DevsegFilterPlugin::postCondition(const QAction* action) const {
    const unsigned writes = declaration(ID(action)).writes;
    int mask = MeshModel::MM_NONE;
    if (writes & devseg::writes_charts)
        mask |= MeshModel::MM_FACEFLAG;
    if (writes & devseg::writes_quality)
        mask |= MeshModel::MM_FACEQUALITY;
    if (writes & devseg::writes_color)
        mask |= MeshModel::MM_FACECOLOR;
    if (writes & devseg::writes_uv)
        mask |= MeshModel::MM_WEDGTEXCOORD;
    return mask;
}

RichParameterList DevsegFilterPlugin::initParameterList(const QAction* action, const MeshModel&) {
    RichParameterList list;
    for (const Parameter& p : declaration(ID(action)).parameters)
        add_parameter(list, p);
    return list;
}

std::map<std::string, QVariant> DevsegFilterPlugin::applyFilter(const QAction* action,
                                                                const RichParameterList& parameters,
                                                                MeshDocument& document,
                                                                unsigned int& post_condition_mask,
                                                                vcg::CallBackPos* callback) {
    const FilterDeclaration& filter = declaration(ID(action));
    MeshModel* model = document.mm();
    if (model == nullptr)
        throw MLException("expected a mesh, found none; load one first");

    devseg::Progress progress([callback](double fraction, const char* phase) {
        return callback == nullptr || callback(static_cast<int>(100.0 * fraction), phase);
    });
    devseg::ParameterValues values;
    for (const Parameter& p : filter.parameters)
        values[p.name] = read_parameter(parameters, p);
    try {
        const devseg::HostResult result =
            devseg::run_filter(filter, devseg::read_host_mesh(*model), values, progress);
        post_condition_mask = devseg::write_host_result(*model, result);
        if (result.layer)
            devseg::fill_layer(*document.addNewMesh("", text(result.layer->name)), *result.layer);
        for (const std::string& note : result.notes)
            log(note);
        std::map<std::string, QVariant> returned;
        for (const auto& [name, value] : result.values) {
            returned[name] = to_variant(value);
            log(name + ": " + to_text(value));
        }
        return returned;
    } catch (const devseg::InvalidMesh& error) {
        if (!error.faces.empty())
            devseg::select_faces(model->cm, error.faces);
        throw MLException(text(error.what()));
    } catch (const std::bad_alloc&) {
        throw MLException("expected enough memory for this mesh, found too little; "
                          "use a smaller mesh or close other programs");
    } catch (const std::exception& error) {
        throw MLException(text(error.what()));
    }
}
