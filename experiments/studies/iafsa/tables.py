"""The tables of the IAFSA paper and the document that shows them."""

from experiments.studies.iafsa.convergence_tables import convergence_tables
from experiments.studies.iafsa.function_tables import function_tables, shifted_tables
from experiments.studies.iafsa.route_tables import route_tables
from experiments.tables.document import document_of_suite

TABLES = {
    "iafsa-functions": function_tables,
    "iafsa-convergence": convergence_tables,
    "iafsa-shifted": shifted_tables,
    "iafsa-routes": route_tables,
}
DOCUMENTS = {"iafsa": document_of_suite("docs/iafsa-paper.md", "iafsa-paper")}
