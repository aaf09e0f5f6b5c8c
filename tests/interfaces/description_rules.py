"""The rules by which 3D Slicer's parser takes a module description or refuses it.

Written down from SlicerExecutionModel, ModuleDescriptionParser/ModuleDescriptionParser.cxx (startElement, endElement)
and, for the order of the head, ModuleDescription.xsd beside it.
"""
import re
import xml.etree.ElementTree as ElementTree

VARIABLE = re.compile(r"[A-Za-z_][A-Za-z0-9_]*\Z")
HEAD = ["category", "title", "description", "version", "documentation-url", "license", "contributor"]
BOOL = {"true", "false"}
ANY = None
# tag -> attribute -> values that the parser takes (ANY: all)
PARAMETERS = {
    "integer": {"multiple": BOOL, "hidden": BOOL}, "float": {"multiple": BOOL, "hidden": BOOL},
    "double": {"multiple": BOOL, "hidden": BOOL}, "string": {"multiple": BOOL, "hidden": BOOL},
    "boolean": {"hidden": BOOL}, "integer-vector": {}, "float-vector": {}, "double-vector": {}, "string-vector": {},
    "point": {"multiple": BOOL, "coordinateSystem": {"ijk", "lps", "ras"}},
    "region": {"multiple": BOOL, "coordinateSystem": {"ijk", "lps", "ras"}},
    "string-enumeration": {"hidden": BOOL}, "integer-enumeration": {"hidden": BOOL},
    "float-enumeration": {"hidden": BOOL}, "double-enumeration": {"hidden": BOOL},
    "file": {"multiple": BOOL, "fileExtensions": ANY}, "directory": {"multiple": BOOL},
    "image": {"multiple": BOOL, "fileExtensions": ANY, "hidden": BOOL, "reference": ANY,
              "type": {"any", "scalar", "label", "tensor", "diffusion-weighted", "vector"}},
    "geometry": {"multiple": BOOL, "aggregate": BOOL, "fileExtensions": ANY, "type": {"fiberbundle", "model"}},
}
CHILDREN = {"name", "flag", "longflag", "label", "description", "default", "element", "channel", "index",
            "constraints"}


def text(node, tag):
    found = node.find(tag)
    return "" if found is None or found.text is None else found.text.strip()


def parameter_faults(node):
    where = f"<{node.tag}> {text(node, 'name')}"
    if node.tag not in PARAMETERS:
        return [f"{where}: no such kind of parameter"]
    faults = []
    for name, value in node.attrib.items():
        if name not in PARAMETERS[node.tag]:
            faults.append(f"{where}: no attribute {name}")
        elif PARAMETERS[node.tag][name] is not ANY and value not in PARAMETERS[node.tag][name]:
            faults.append(f"{where}: {name} cannot be '{value}'")
    faults += [f"{where}: unknown element <{child.tag}>" for child in node if child.tag not in CHILDREN]
    if not VARIABLE.match(text(node, "name")):
        faults.append(f"{where}: bad name")
    long_flag, flag, index = text(node, "longflag").lstrip("-"), text(node, "flag").lstrip("-"), text(node, "index")
    if long_flag and not VARIABLE.match(long_flag):
        faults.append(f"{where}: longflag '{long_flag}' may have letters, digits and underscores only")
    if len(flag) > 1:
        faults.append(f"{where}: flag '{flag}' has more than one character")
    if bool(long_flag or flag) == bool(index):
        faults.append(f"{where}: a flag or an index is needed, not both")
    if node.tag in ("image", "geometry", "file") and text(node, "channel") not in ("input", "output"):
        faults.append(f"{where}: a channel is needed")
    if not text(node, "label") or not text(node, "description"):
        faults.append(f"{where}: a person wants a label and a description")
    elements = [(element.text or "").strip() for element in node.findall("element")]
    if node.tag.endswith("-enumeration") != bool(elements):
        faults.append(f"{where}: elements are for enumerations")
    if elements and text(node, "default") not in elements:
        faults.append(f"{where}: the default is no choice")
    if node.tag in ("double", "float", "integer"):
        try:
            float(text(node, "default"))
        except ValueError:
            faults.append(f"{where}: the host always hands over a number, so it needs a default")
    return faults


def description_faults(xml):
    try:
        root = ElementTree.fromstring(xml)
    except ElementTree.ParseError as fault:
        return [f"no XML: {fault}"]
    if root.tag != "executable":
        return ["<executable> must be the outermost tag"]
    faults = []
    tags = [child.tag for child in root]
    groups = root.findall("parameters")
    if tags != HEAD + ["parameters"] * len(groups) or not groups:
        faults.append(f"the head is not {HEAD} and then parameters: {tags}")
    names = []
    for group in groups:
        if group.attrib and list(group.attrib.items()) not in ([("advanced", "true")], [("advanced", "false")]):
            faults.append(f"<parameters> cannot have {group.attrib}")
        if not text(group, "label"):
            faults.append("a group has no label")
        for node in group:
            if node.tag not in ("label", "description"):
                faults += parameter_faults(node)
                names.append(text(node, "name"))
    faults += [f"{name}: given twice" for name in set(names) if names.count(name) > 1]
    return faults
