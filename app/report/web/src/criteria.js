// Criteria by which a number of components is chosen.

export const criteria = [['bic', 'BIC'], ['icl', 'ICL'], ['aic', 'AIC'], ['heldout', 'held out [nats]']];

// A criterion over the number of components, as a line through the candidates that were fitted. `y`: row => its value,
// `name`: of the line, in the texts, too.
export function criterionTrace(candidates, key, name, y = (row) => row[key].v) {
  const rows = candidates.filter((row) => row.status === 'fitted' && y(row) !== null);
  return {
    type: 'scatter',
    mode: 'lines+markers',
    name,
    hoverinfo: 'text',
    x: rows.map((row) => row.components),
    y: rows.map(y),
    text: rows.map((row) => `${name}, K = ${row.components}: ${row[key].t}`),
    customdata: rows.map((row) => row.selected),
  };
}
