"""HTML of the site for readers who use a keyboard or a screen reader: what the theme leaves out."""

# By opening tag as Sphinx and its theme Furo write it, the attributes that it lacks. Headings of lists have
# no level, two landmarks have no name, and boxes that scroll sideways cannot be reached by keyboard.
MISSING = {
    '<p class="caption" role="heading"': 'aria-level="2"',
    '<aside class="sidebar-drawer"': 'aria-label="Site"',
    '<aside class="toc-drawer"': 'aria-label="On this page"',
    '<aside class="toc-drawer no-toc"': 'aria-label="On this page"',
    '<div class="highlight"><pre': 'tabindex="0"',
    '<div class="table-wrapper colwidths-auto docutils container"': (
        'tabindex="0" role="group" aria-label="Table"'
    ),
    '<div class="table-wrapper colwidths-given docutils container"': (
        'tabindex="0" role="group" aria-label="Table"'
    ),
    '<div class="table-wrapper docutils container"': 'tabindex="0" role="group" aria-label="Table"',
}


def accessible(page: str) -> str:
    """Return an HTML page with the attributes that tags lack; a page that has them stays as it is."""
    for tag, attributes in MISSING.items():
        page = page.replace(f"{tag}>", f"{tag} {attributes}>")
    return page
