"""The tables and the document of the study of maps that change."""

from experiments.studies.dynamic.over_time import over_time_tables
from experiments.studies.dynamic.recovery import recovery_tables
from experiments.studies.dynamic.robots import robot_tables
from experiments.studies.dynamic.seeing import seeing_tables
from experiments.tables.document import document_of_suite

TABLES = {
    "recovery": recovery_tables,
    "over-time": over_time_tables,
    "seeing": seeing_tables,
    "robots": robot_tables,
}
DOCUMENTS = {"dynamic": document_of_suite("docs/dynamic.md", "dynamic-study")}
