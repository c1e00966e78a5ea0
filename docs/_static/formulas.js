// Formulas as Sphinx writes them: \( \) within text, \[ \] displayed.
document.addEventListener('DOMContentLoaded', () => {
  const delimiters = [
    {left: '\\[', right: '\\]', display: true},
    {left: '\\(', right: '\\)', display: false},
  ];
  for (const element of document.querySelectorAll('.math'))
    window.renderMathInElement(element, {delimiters, throwOnError: false});
});
